# The emulated microcontroller board: the program boresight-mcu, which links libunicorn (GPL), and its tests.
# libchip.a has the registers, which need no processor; libmcu.a the processor and what it runs on.
mcu_c := $(wildcard host-sim/mcu/*.c)
cpu_c := $(patsubst %,host-sim/mcu/%.c,cpu cpu_exception machine probe mcu_board)
chip_c := $(filter-out $(cpu_c) %/program.c %/quick_stores.c,$(mcu_c))
# Tests of libchip.a are one program a part; those of libmcu.a also need images.
cpu_test_c := $(wildcard tests/mcu/cpu/*.c)
chip_test_c := $(wildcard tests/mcu/*.c)

# Without libunicorn there is no boresight-mcu: `make emulator` and `make check` install it.
unicorn := $(wildcard $(sysroot)/usr/include/unicorn/unicorn.h)
mcu_runs := $(foreach v,gcc san,$(chip_test_c:%.c=$(v)/%))
ifneq ($(unicorn),)
mcu_runs += $(cpu_test_c:%.c=gcc/%)
mcu_scripts := $(wildcard tests/mcu/cpu/*.sh)
else
mcu_scripts := tests/mcu/no_emulator.sh
endif

# libunicorn shows all symbols of the QEMU inside it, and calls ours of the same name (cpu_reset) unless they are hidden.
mcu_link := -Wl,--exclude-libs,ALL

define mcu_rules
$(B)/$(1)/libchip.a: $(chip_c:%.c=$(B)/$(1)/%.o)
$(B)/$(1)/libmcu.a: $(cpu_c:%.c=$(B)/$(1)/%.o)
# quick_stores.o is in no archive: it must be seen by libunicorn.
$(1)_mcu := $(B)/$(1)/host-sim/mcu/quick_stores.o $(B)/$(1)/libmcu.a $(B)/$(1)/libchip.a
$(B)/$(1)/boresight-mcu: $(B)/$(1)/boards/linux/main.o $(B)/$(1)/host-sim/mcu/program.o $$($(1)_mcu) $$($(1)_libs)
	$$(say) LD $$@
	$$($(1)_cc) $$($(1)_ld) $(mcu_link) -o $$@ $$^ -lunicorn -ljansson $(feature_libs) -lm
$(cpu_test_c:%.c=$(B)/$(1)/%): $(B)/$(1)/tests/mcu/cpu/%: $(B)/$(1)/tests/mcu/cpu/%.o $(B)/$(1)/libtest.a \
    $$($(1)_mcu) $$($(1)_libs)
	$$(say) LD $$@
	$$($(1)_cc) $$($(1)_ld) $(mcu_link) -o $$@ $$^ -lunicorn -ljansson $(feature_libs) -lm
$(chip_test_c:%.c=$(B)/$(1)/%): $(B)/$(1)/tests/mcu/%: $(B)/$(1)/tests/mcu/%.o $(B)/$(1)/libtest.a \
    $(B)/$(1)/libchip.a $(B)/$(1)/libsim.a $(B)/$(1)/libfirmware.a
	$$(say) LD $$@
	$$($(1)_cc) $$($(1)_ld) -o $$@ $$^ -lm
-include $(patsubst %.c,$(B)/$(1)/%.d,$(mcu_c) $(cpu_test_c) $(chip_test_c))
endef
$(foreach v,$(variants),$(eval $(call mcu_rules,$(v))))

$(B)/boresight-mcu: $(B)/gcc/boresight-mcu
	@cp $< $@

# What `make demo` shows of a board, if the compiler for it and the emulator are there.
ifneq ($(and $(unicorn),$(shell command -v arm-none-eabi-gcc)),)
demo_board := $(B)/boresight-mcu $(B)/boards/stm32f405/boresight.elf
define show_board
	echo 'The same sky once more, now by the image of the STM32F405 in an emulated chip:'
	mkdir -p $(B)/demo/stm32f405
	$(B)/boresight sim $(1) --mcu $(B)/boards/stm32f405/boresight.elf --mcu-console $(B)/demo/stm32f405/console.txt \
	    --report $(B)/demo/stm32f405 >$(B)/demo/stm32f405/summary.txt
	echo 'What it said on its serial line, with the time in seconds:'
	awk 'NR <= 4 || NR % 10 == 0 { print "  " $$0 }' $(B)/demo/stm32f405/console.txt
	echo 'What came of it (mcu_step: instructions of a step of the controller):'
	grep -E '^(aim_error|in_frame|violations|mcu_(steps|complaints|step_m|loop_p))' $(B)/demo/stm32f405/summary.txt
	echo
	echo 'The report of that run: $(B)/demo/stm32f405/report.html; all that the board said: console.txt there'
endef
else
define show_board
	echo 'With gcc-arm-none-eabi and libunicorn-dev the demo also shows the STM32F405: make emulator'
endef
endif

.PHONY: emulator
emulator: ## Build boresight-mcu, which runs a board's image in the simulator (sim --mcu)
	@.ci/need emulator
	@$(MAKE) --no-print-directory $(B)/boresight $(B)/boresight-mcu

# An image for the rig of tests/mcu/cpu/faults.c.
$(B)/boards/stm32f405/slew/rig.c: tests/mcu/cpu/slew/slew.ini $(B)/boresight FORCE
	@mkdir -p $(@D)
	$(call write_rig,$<,$@)

# And one with a yard in its flash that hides targets (tests/mcu/cpu/hidden.c).
$(B)/boards/stm32f405/hidden/rig.c: tests/mcu/cpu/hidden/hidden.ini $(B)/boresight FORCE
	@mkdir -p $(@D)
	$(call write_rig,$<,$@)
$(eval $(call scene_rules,stm32f405,hidden,tests/mcu/cpu/hidden/yard.scene,$(B)/boards/stm32f405/hidden/rig.o))

# Programs for the emulated processor in the tests: one file each, with a start-up of their own.
guest_c := $(wildcard tests/mcu/guest/*.c)
guest_flags := -std=c11 -O2 -g $(warnings) -ffreestanding -ffunction-sections -mcpu=cortex-m4 -mthumb \
    -mfloat-abi=soft -Itests/mcu/guest
$(B)/guest/%.elf: tests/mcu/guest/%.c tests/mcu/guest/start.c $(wildcard tests/mcu/guest/*.h) tests/mcu/guest/guest.ld
	@mkdir -p $(@D)
	$(say) LD $@
	arm-none-eabi-gcc $(guest_flags) -nostdlib -nostartfiles -Wl,--gc-sections,--build-id=none,--no-warn-rwx-segments \
	    -T tests/mcu/guest/guest.ld -o $@ $(filter %.c,$^) -lgcc
guests := $(patsubst tests/mcu/guest/%.c,$(B)/guest/%.elf,$(filter-out %/start.c,$(guest_c)))
