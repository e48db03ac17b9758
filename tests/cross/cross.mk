# The program for ARM Linux, as `make CROSS=TARGET-` builds it, under emulation (arm.sh). The group `pi` of tests/vm runs it on a kernel.
cross_targets := aarch64-linux-gnu arm-linux-gnueabihf
cross_logs := $(cross_targets:%=$(B)/check/cross/%.log)
test_runs += $(cross_targets:%=cross/%)
.PHONY: need-cross
need-cross: | need-check
	@.ci/need cross || true
$(cross_logs): $(B)/check/cross/%.log: $(digest_c:%.c=$(B)/gcc/%) $(B)/boresight FORCE
	+@tests/run.sh $@ sh tests/cross/arm.sh $*
