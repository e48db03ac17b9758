# Boresight. `make help` lists the targets; everything is written to build/.
VERSION := 0.1.0
PREFIX ?= /usr/local
B := build

# For another machine, `make CROSS=aarch64-linux-gnu-` (or arm-linux-gnueabihf-) writes build/aarch64-linux-gnu/boresight.
# SYSROOT: a folder with that system's /usr and /lib; if none is named, Debian's packages of the libraries are fetched once.
target :=
sysroot :=
ifneq ($(CROSS),)
target := $(notdir $(CROSS:%-=%))
B := build/$(target)
sysroot := $(or $(SYSROOT),$(shell sh boards/linux/cross/sysroot.sh $(target)))
$(if $(and $(sysroot),$(wildcard $(sysroot)/usr/include)),,$(error no libraries for $(target) (SYSROOT=FOLDER names them)))
endif

# All cores, unless the caller says otherwise; one target's output stays together.
ifeq ($(MAKELEVEL)$(filter -j% --jobserver%,$(MAKEFLAGS)),0)
MAKEFLAGS += -j$(shell nproc 2>/dev/null || echo 2)
endif
MAKEFLAGS += --output-sync=target --no-builtin-rules
.SUFFIXES:
.DELETE_ON_ERROR:
.DEFAULT_GOAL := all

# `make V=1` shows the commands; otherwise a line a file.
ifeq ($(V),1)
say = @:
else
.SILENT:
say = @printf '  %-6s %s\n'
endif

# ---------------------------------------------------------------- sources
firmware_c := $(wildcard firmware/*/*.c)
include boards/linux/features.mk
hal_c := $(filter-out $(not_built),$(wildcard hal/*.c hal/linux/*.c))
sim_c := $(filter-out host-sim/mcu/%,$(wildcard host-sim/*.c host-sim/*/*.c))
program_c := $(filter-out $(not_built),$(wildcard boards/linux/*.c boards/linux/*/*.c))
test_support_c := $(wildcard tests/*.c tests/contract/support/*.c tests/property/support/*.c tests/vm/support/*.c)
# Brute force in the compiler's 128-bit integers and GMP's 64-bit ones is for systems that have them.
test_support_c := $(if $(filter arm-%,$(target)),$(filter-out tests/property/%,$(test_support_c)),$(test_support_c))
# Each of these files is one test program.
unit_c := $(wildcard tests/unit/*.c)
host_test_c := $(wildcard tests/cli/*.c tests/contract/*.c tests/property/*.c tests/scenario/*.c)
# Programs for the virtual machine.
vm_test_c := $(wildcard tests/vm/*.c)
test_scripts := $(filter-out tests/gate/verdict.sh,$(wildcard tests/cli/*.sh tests/gate/*.sh))
mcu_test_c := $(wildcard tests/mcu/*.c tests/mcu/*/*.c tests/mcu/*/*/*.c)
all_c := $(firmware_c) $(hal_c) $(sim_c) $(program_c) $(test_support_c) $(unit_c) $(host_test_c) $(mcu_test_c) $(vm_test_c)

# ---------------------------------------------------------------- flags
# A named whole number (enum) may stand in a sum of doubles; newer clangs warn of that within -Wconversion.
warnings := -Wall -Wextra -Werror -Wshadow -Wconversion -Wstrict-prototypes -Wmissing-prototypes -Wvla \
    -Wundef -Wcast-qual -Wwrite-strings -Wpointer-arith -Wno-enum-float-conversion
common := -std=c11 -g $(warnings) -ffp-contract=off -fno-common
# firmware/ is freestanding and has no floating point: with this flag a float does not compile.
firmware_flags := -ffreestanding -mgeneral-regs-only -Ifirmware -Ihal/include
# Files and times beyond 2^31 on 32-bit systems, too (no time is handed to a library, which may have been built without).
host_flags := -D_GNU_SOURCE -D_FILE_OFFSET_BITS=64 -D_TIME_BITS=64 -include $(B)/features.h -Ifirmware -Ihal/include -Ihal -Ihost-sim -Iboards/linux -Itests
arm_flags := -std=c11 -O2 -g $(warnings) -ffreestanding -ffunction-sections -fdata-sections -fstack-usage \
    -mthumb -mfloat-abi=soft -Ifirmware -Ihal/include

# A variant is a compiler with flags; its files are below build/VARIANT/. gcc is what is installed.
gcc_cc := $(CROSS)gcc $(sysroot:%=--sysroot=%)
gcc_flags := -O2
clang_cc := clang $(target:%=--target=%) $(sysroot:%=--sysroot=%)
clang_flags := -O2
# The debug build: with BORESIGHT_DEBUG the methods of the cone prove each of their own answers.
san_cc := $(clang_cc)
san_flags := -O1 -DBORESIGHT_DEBUG -fno-omit-frame-pointer -fsanitize=address,undefined -fno-sanitize-recover=all
san_ld := -fsanitize=address,undefined
variants := gcc clang san
arm_cores := cortex-m0plus cortex-m4

# ---------------------------------------------------------------- build id
# The file changes only when its text does, so that a commit doesn't rebuild the tree.
commit := $(shell git rev-parse --short=12 HEAD 2>/dev/null || echo unknown)
dirty := $(shell test -z "$$(git status --porcelain --untracked-files=no 2>/dev/null)" || echo -dirty)
build_id := $(VERSION) $(commit)$(dirty)
$(B)/build_id.c: FORCE
	@mkdir -p $(@D)
	@echo 'extern const char build_id[];' > $@.new
	@echo 'const char build_id[] = "$(build_id)";' >> $@.new
	@cmp -s $@.new $@ && rm $@.new || mv $@.new $@

# ---------------------------------------------------------------- one variant
define variant_rules
$(B)/$(1)/firmware/%.o: firmware/%.c
	@mkdir -p $$(@D)
	$$(say) CC $$@
	$$($(1)_cc) $(common) $$($(1)_flags) $(firmware_flags) -MMD -MP -c $$< -o $$@
$(B)/$(1)/build_id.o: $(B)/build_id.c
	@mkdir -p $$(@D)
	$$($(1)_cc) $(common) $$($(1)_flags) -c $$< -o $$@
$(B)/$(1)/%.o: %.c
	@mkdir -p $$(@D)
	$$(say) CC $$@
	$$($(1)_cc) $(common) $$($(1)_flags) $(host_flags) -MMD -MP -c $$< -o $$@

$(B)/$(1)/libfirmware.a: $(firmware_c:%.c=$(B)/$(1)/%.o) $(B)/$(1)/build_id.o
$(B)/$(1)/libhal.a: $(hal_c:%.c=$(B)/$(1)/%.o)
$(B)/$(1)/libsim.a: $(sim_c:%.c=$(B)/$(1)/%.o)
# The program's files but its main(), for the tests that link them.
$(B)/$(1)/libprogram.a: $(patsubst %.c,$(B)/$(1)/%.o,$(filter-out boards/linux/main.c,$(program_c)))
$(B)/$(1)/libtest.a: $(test_support_c:%.c=$(B)/$(1)/%.o)
$(B)/$(1)/lib%.a:
	@rm -f $$@
	$$(say) AR $$@
	$(CROSS)ar rcs $$@ $$^

$(1)_libs := $(foreach l,program sim hal firmware,$(B)/$(1)/lib$(l).a)
$(B)/$(1)/boresight: $(B)/$(1)/boards/linux/main.o $$($(1)_libs)
	$$(say) LD $$@
	$$($(1)_cc) $$($(1)_ld) -o $$@ $$^ -Wl,--as-needed -ljansson $(feature_libs) -lm
$(B)/$(1)/tests/%: $(B)/$(1)/tests/%.o $(B)/$(1)/libtest.a $$($(1)_libs)
	$$(say) LD $$@
	$$($(1)_cc) $$($(1)_ld) -o $$@ $$^ -Wl,--as-needed -ljansson $(feature_libs) -lmpfr -lgmp -lm
-include $(all_c:%.c=$(B)/$(1)/%.d)
endef
$(foreach v,$(variants),$(eval $(call variant_rules,$(v))))

# firmware/ as the microcontrollers get it: nothing may lean on the host.
define arm_rules
$(B)/$(1)/%.o: %.c
	@mkdir -p $$(@D)
	$$(say) CC $$@
	arm-none-eabi-gcc $(arm_flags) -mcpu=$(1) -MMD -MP -c $$< -o $$@
-include $(firmware_c:%.c=$(B)/$(1)/%.d)
endef
$(foreach c,$(arm_cores),$(eval $(call arm_rules,$(c))))
arm_objects := $(foreach c,$(arm_cores),$(firmware_c:%.c=$(B)/$(c)/%.o))

.SECONDARY:
.PHONY: FORCE
FORCE:

include boards/boards.mk
include host-sim/mcu/emulator.mk
include tests/tests.mk
include tests/bench/bench.mk

# ---------------------------------------------------------------- targets
.PHONY: all help demo check lint format size install uninstall clean
scenarios := host-sim/scenarios
demo: ## Run the main job in the simulator: ten constellations, a group of pedestrians, a flight through a city
	.ci/need demo
	$(MAKE) --no-print-directory demo-run

.PHONY: demo-run
demo-run: $(B)/boresight $(demo_board)
	$(B)/boresight sim $(scenarios)/stars.ini $(scenarios)/pedestrians.ini $(scenarios)/flight.ini --report $(B)/demo
	echo
	$(call show_board,$(scenarios)/stars.ini)
	echo 'The report, with plots and pictures: $(B)/demo/report.html'

lint: ## Check layers, layout and lengths
	sh tests/gate/layers.sh
	sh tests/gate/style.sh

format: ## Lay out every C file
	clang-format -i $$(git ls-files --cached --others --exclude-standard '*.c' '*.h')

size: $(arm_objects) ## Print the flash of each folder and the RAM of a controller
	tests/gate/check/size-table.sh

all: $(B)/boresight $(if $(unicorn),$(B)/boresight-mcu) ## Build the program (build/boresight), and boresight-mcu if it can be; for a Raspberry Pi: CROSS=aarch64-linux-gnu-
$(B)/boresight: $(B)/gcc/boresight
	@cp $< $@

.PHONY: figures
figures: $(B)/boresight ## Draw the figures of docs/geometry.md and docs/regular.md
	sh docs/pictures/draw.sh docs/pictures

help: ## List the targets
	@grep -hE '^[a-z-]+:.*## ' Makefile boards/boards.mk tests/tests.mk tests/vm/vm.mk tests/bench/bench.mk | sed -E 's/:.*## /\t/' | sort | expand -t 16

# Beside the program: who may use the devices (udev), the service, and rig files to begin with (docs/rig.md).
package := boards/linux/package
share := $(DESTDIR)$(PREFIX)/share/boresight
rules := $(DESTDIR)$(PREFIX)/lib/udev/rules.d/70-boresight.rules
service := $(DESTDIR)$(PREFIX)/lib/systemd/system/boresight.service
install: $(B)/boresight ## Install the program, its service, device rules and rig files (PREFIX, DESTDIR)
	install -D -m 755 $(B)/boresight $(DESTDIR)$(PREFIX)/bin/boresight
	install -D -m 644 $(package)/70-boresight.rules $(rules)
	install -d $(dir $(service)) $(share)/rigs
	sed 's|@PREFIX@|$(PREFIX)|' $(package)/boresight.service >$(service)
	chmod 644 $(service)
	install -m 644 $(package)/80-can.network $(share)
	install -m 644 boards/linux/rigs/*.ini $(share)/rigs

uninstall: ## Remove what install installed
	rm -rf $(DESTDIR)$(PREFIX)/bin/boresight $(rules) $(service) $(share)

clean: ## Remove build/
	rm -rf $(B)
