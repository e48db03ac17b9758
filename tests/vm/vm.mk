# The tests in the virtual machine. tests/README.md explains it.

# Groups (tests/vm/guest/GROUP.sh), in the order in which they run; with -san their C programs are built with sanitizers.
vm_groups := can gpio usb gs_usb run calibrate rig buses camera can-san gpio-san usb-san gs_usb-san camera-san
vm_programs := $(foreach v,gcc san,$(vm_test_c:%.c=$(B)/$(v)/%))

# The driver's file for libgpiod 2.x, on what stands for that library (gpiod2/), whichever version the host has.
gpiod2 := $(B)/gcc/tests/vm/gpiod2
$(gpiod2)/driver.o: hal/linux/linux_gpiod_2.c hal/linux/linux_gpiod.h hal/linux/linux_gpio.h tests/vm/gpiod2/gpiod.h
	@mkdir -p $(@D)
	$(say) CC $@
	$(gcc_cc) $(common) $(gcc_flags) -isystem tests/vm/gpiod2 $(host_flags) -c $< -o $@
$(B)/gcc/tests/vm/linux_gpio_2: $(B)/gcc/tests/vm/linux_gpio.o $(gpiod2)/driver.o $(gpiod2)/gpiod2.o $(B)/gcc/libtest.a $(gcc_libs)
	$(say) LD $@
	$(gcc_cc) -o $@ $^ -Wl,--as-needed -ljansson $(feature_libs) -lmpfr -lgmp -lm
vm_programs += $(B)/gcc/tests/vm/linux_gpio_2

# Without what it needs they are skipped, by name.
.PHONY: need-vm check-vm check-vm-run
need-vm: | need-check
	@.ci/need vm || true
# A machine a group: what one of them leaves behind, or hangs, is no other's.
vm_logs := $(vm_groups:%=$(B)/check/vm/%.log)
$(vm_logs): $(B)/check/vm/%.log: $(vm_programs) $(B)/boresight FORCE
	@tests/run.sh $@ sh tests/vm/run.sh $*
check-vm: need-vm ## Run the tests of hardware on a real kernel in a virtual machine
	@$(MAKE) --no-print-directory check-vm-run
check-vm-run: $(vm_programs) $(B)/boresight
	@for log in $(vm_logs); do $(MAKE) --no-print-directory $$log; done
	@tests/summary.sh $(vm_logs)
