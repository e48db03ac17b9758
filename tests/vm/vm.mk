# The tests in the virtual machine. tests/README.md explains it.

# Groups (tests/vm/guest/GROUP.sh), in the order in which they run; with -san their C programs are built with sanitizers.
vm_groups := can gpio usb gs_usb run calibrate rig buses serial board camera loop refusals pi can-san gpio-san usb-san gs_usb-san camera-san
vm_programs := $(foreach v,gcc san,$(vm_test_c:%.c=$(B)/$(v)/%))

# Where the distribution has libgpiod 1.6, the driver's file for 2.x with that library as Debian's next release has it.
# Not built where it can't be had; tests/vm/guest/gpio.sh tells.
ifeq ($(gpiod),1)
vm_programs += $(B)/gcc/tests/vm/linux_gpio_2
$(B)/gcc/tests/vm/linux_gpio_2: hal/linux/linux_gpiod_2.c $(B)/gcc/tests/vm/linux_gpio.o $(B)/gcc/libtest.a $(gcc_libs) hal/linux/linux_gpiod.h hal/linux/linux_gpio.h tests/vm/packages.sh
	@rm -f $@
	$(say) LD $@
	@from=$$(sh tests/vm/packages.sh trixie libgpiod-dev) || exit 0; \
	$(gcc_cc) $(common) $(gcc_flags) -isystem "$$from/usr/include" $(host_flags) -o $@ $(filter %.c %.o %.a,$^) "$$from"/usr/lib/*/libgpiod.a \
	    -Wl,--as-needed -ljansson $(filter-out -lgpiod,$(feature_libs)) -lmpfr -lgmp -lm
endif

# What is put between a program and the C library, to see what it does.
watch_loop := $(B)/gcc/tests/vm/preload/watch_loop.so
$(watch_loop): tests/vm/preload/watch_loop.c
	@mkdir -p $(@D)
	$(say) LD $@
	$(gcc_cc) $(common) $(gcc_flags) -U_GNU_SOURCE -shared -fPIC -o $@ $< -ldl
vm_programs += $(watch_loop)
$(foreach d,script script-san,$(B)/check/$(d)/tests/cli/run_aside.log): $(watch_loop)

# Without what it needs they are skipped, by name.
.PHONY: need-vm check-vm check-vm-run
need-vm: | need-check need-cross
	@.ci/need vm || true
# A machine a group: what one of them leaves behind, or hangs, is no other's.
vm_logs := $(vm_groups:%=$(B)/check/vm/%.log)
$(vm_logs): $(B)/check/vm/%.log: $(vm_programs) $(B)/boresight FORCE
	@tests/run.sh $@ sh tests/vm/run.sh $*
# Without compiler or emulator of the board that group says so.
$(B)/check/vm/board.log: $(if $(and $(unicorn),$(shell command -v arm-none-eabi-gcc)),$(B)/boresight-mcu $(B)/boards/stm32f405/boresight.elf)
check-vm: need-vm ## Run the tests of hardware on a real kernel in a virtual machine
	@$(MAKE) --no-print-directory check-vm-run
check-vm-run: $(vm_programs) $(B)/boresight
	@for log in $(vm_logs); do $(MAKE) --no-print-directory $$log; done
	@tests/summary.sh $(vm_logs)
