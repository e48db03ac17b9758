# The tests, as the Makefile sees them. tests/README.md explains what each folder holds.

# A unit test runs in all variants; the others where they say something new: once with gcc, and (tests of
# readers, contracts and scenarios, which touch the most memory) once with the sanitizers.
# Half a minute of real time each, and scenarios or contracts show the sanitizers the same code.
once := $(foreach t,drives hidden,tests/cli/$(t).sh)
test_runs := $(foreach v,$(variants),$(unit_c:%.c=$(v)/%)) \
    $(host_test_c:%.c=gcc/%) \
    $(patsubst %.c,san/%,$(filter tests/cli/% tests/contract/% tests/scenario/%,$(host_test_c))) \
    $(patsubst %.c,san/%,$(filter tests/property/scene_tree% tests/property/scene_shape%,$(host_test_c))) \
    $(test_scripts:%.sh=script/%) \
    $(patsubst %.sh,script-san/%,$(filter-out $(once),$(filter tests/cli/%,$(test_scripts)))) \
    $(mcu_runs) $(mcu_scripts:%.sh=script/%)
include tests/mcu/mps2/mps2.mk
include tests/mcu/tick/tick.mk
test_runs += script/tests/mcu/rp2040/pico
include tests/mcu/hal/hal.mk
include tests/cross/cross.mk
include tests/vm/vm.mk
# In real time: one after the other when all others are done, and again if the machine paused.
realtime := cli/board cli/run_aside cli/run_wait cli/calibrate cli/camera cli/camera_loop cli/camera_run cli/capacity cli/drive cli/drives cli/hidden mcu/cpu/link \
    contract/linux_gs_usb contract/linux_gpio_edges scenario/test_event_loop scenario/test_eye scenario/test_rig_mend
realtime_runs := $(filter $(foreach t,$(realtime),%/tests/$(t)),$(test_runs)) $(vm_groups:%=vm/%)
logs := $(patsubst %,$(B)/check/%.log,$(filter-out $(realtime_runs),$(test_runs)))
realtime_logs := $(realtime_runs:%=$(B)/check/%.log)
$(realtime_logs): export TRIES := 3

.PHONY: need-check
need-check:
	@.ci/need check

$(B)/check/script/tests/gate/symbols.log: $(arm_objects) $(B)/gcc/libfirmware.a
$(B)/check/script/tests/gate/image.log: $(mcu_boards:%=$(B)/boards/%/boresight.elf) $(scene_boards:%=$(B)/boards/%/scene/boresight.elf)
$(B)/check/script/tests/gate/boot.log: $(B)/boards/stm32f405/boresight.elf
$(B)/check/script/tests/gate/levine.log: $(B)/bench-levine
$(B)/check/script/tests/gate/reproducible.log: $(foreach b,$(mcu_boards),$($(b)_files))

$(B)/check/script/tests/mcu/rp2040/pico.log: $(pico_files) $(B)/gcc/tests/mcu/rp2040/plant

$(foreach v,gcc san,$(B)/check/$(v)/tests/cli/stars.log): $(B)/boresight

$(foreach d,script script-san,$(foreach t,drive camera_loop,$(B)/check/$(d)/tests/cli/$(t).log)): $(foreach v,$(variants),$(B)/$(v)/boresight)

$(foreach t,$(cpu_test_c:%.c=gcc/%) $(mcu_scripts:%.sh=script/%),$(B)/check/$(t).log): \
    $(foreach r,/hobby /moving /watch /slew /objects,$(B)/boards/stm32f405$(r)/boresight.elf) $(B)/boards/stm32f405/boresight.elf $(B)/boards/stm32f405/scene/boresight.elf $(B)/boards/stm32f405/hidden/boresight.elf $(guests) $(if $(unicorn),$(B)/boresight-mcu)
$(B)/check/script/tests/mcu/cpu/layout.log: $(B)/gcc/tests/mcu/layout
$(B)/check/script/tests/mcu/cpu/second_opinion.log: $(B)/gcc/tests/mcu/cpu/exceptions
$(B)/check/script/tests/mcu/cpu/same_bits.log: $(B)/gcc/boresight $(B)/clang/boresight
$(foreach d,script script-san,$(B)/check/$(d)/tests/cli/board.log): $(B)/gcc/tests/cli/support/pty_board
$(foreach d,script script-san,$(B)/check/$(d)/tests/cli/refusals.log): $(B)/gcc/tests/cli/support/pty_witness
$(foreach l,script/tests/cli/drives script/tests/cli/run_wait script-san/tests/cli/run_wait,$(B)/check/$(l).log): $(B)/gcc/tests/cli/support/pty_drives
-include $(B)/gcc/tests/cli/support/pty_board.d $(B)/gcc/tests/cli/support/pty_drives.d

# Tests always run. A failing test does not stop the others: its log and its exit status are kept.
$(B)/check/script/%.log: %.sh $(B)/boresight FORCE
	@tests/run.sh $@ sh $<
# The tests of the command line once more, on the program that the sanitizers watch.
$(B)/check/script-san/%.log: %.sh $(B)/san/boresight FORCE
	@tests/run.sh $@ env BORESIGHT=$(B)/san/boresight sh $<
define variant_test
$(B)/check/$(1)/%.log: $(B)/$(1)/% FORCE
	@tests/run.sh $$@ $$<
endef
$(foreach v,$(variants),$(eval $(call variant_test,$(v))))

check: need-check need-vm need-cross ## Run every test that needs no hardware; ends with `N passed, N failed`
	@$(MAKE) --no-print-directory check-all

.PHONY: check-all
check-all: $(logs)
	@for log in $(realtime_logs); do $(MAKE) --no-print-directory $$log; done
	@tests/summary.sh $(logs) $(realtime_logs)
