# The tests in the virtual machine. tests/README.md explains it.

# Groups (tests/vm/guest/GROUP.sh), in the order in which they run; with -san their C programs are built with sanitizers.
vm_groups := can gpio usb run rig buses camera can-san gpio-san usb-san camera-san
vm_programs := $(foreach v,gcc san,$(vm_test_c:%.c=$(B)/$(v)/%))

# Without what it needs they are skipped, by name.
.PHONY: need-vm check-vm check-vm-run
need-vm: | need-check
	@.ci/need vm || true
$(B)/check/vm.log: $(vm_programs) $(B)/boresight FORCE
	@tests/run.sh $@ sh tests/vm/run.sh $(vm_groups)
check-vm: need-vm ## Run the tests of hardware on a real kernel in a virtual machine
	@$(MAKE) --no-print-directory check-vm-run
check-vm-run: $(B)/check/vm.log
	@cat $<
	@tests/summary.sh $<
