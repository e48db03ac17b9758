# Unit tests, vectors and digests on 32-bit processors under QEMU. boards/mps2/README.md explains.
mps2_cores := cortex-m0plus cortex-m4 cortex-m7
# An image for a Cortex-M0+ runs on the Cortex-M3, whose instructions include its own.
cortex-m0plus_machine := mps2-an385
# Without a long multiplication it is slow: a quarter of the rounds of the longest unit tests.
cortex-m0plus_share := -DCHECK_SHARE=4
cortex-m4_machine := mps2-an386
cortex-m7_machine := mps2-an500

ifeq ($(filter cortex-m7,$(arm_cores)),)
$(eval $(call arm_rules,cortex-m7))
endif

mps2_flags := $(arm_flags) -Ihal -Itests -Iboards/mps2
mps2_board_c := $(wildcard boards/mps2/*.c) hal/cortexm/cortexm_memory.c
digest_c := $(wildcard tests/mcu/digest/*.c)
mps2_plant_c := $(wildcard tests/mcu/mps2/plant/*.c)

# $(1): core. With gcc in build/CORE/, where the rules for firmware/ are the Makefile's; with clang in build/clang-CORE/.
# The board's own files are always gcc's.
define mps2_rules
$(B)/$(1)/boards/mps2/%.o: boards/mps2/%.c
	@mkdir -p $$(@D)
	$$(say) CC $$@
	arm-none-eabi-gcc $(mps2_flags) -mcpu=$(1) -MMD -MP -c $$< -o $$@
$(B)/$(1)/hal/cortexm/%.o: hal/cortexm/%.c
	@mkdir -p $$(@D)
	$$(say) CC $$@
	arm-none-eabi-gcc $(mps2_flags) -mcpu=$(1) -MMD -MP -c $$< -o $$@
$(B)/$(1)/tests/%.o: tests/%.c
	@mkdir -p $$(@D)
	$$(say) CC $$@
	arm-none-eabi-gcc $(mps2_flags) $($(1)_share) -mcpu=$(1) -MMD -MP -c $$< -o $$@
$(B)/clang-$(1)/%.o: %.c
	@mkdir -p $$(@D)
	$$(say) CC $$@
	clang --target=arm-none-eabi -fshort-enums $$(filter-out -fstack-usage,$(mps2_flags)) -mcpu=$(1) -MMD -MP -c $$< -o $$@
$(foreach v,$(1) clang-$(1),$(call mps2_image_rule,$(v),$(1)))
-include $(foreach c,$(mps2_board_c) $(firmware_c) $(unit_c) $(digest_c) $(mps2_plant_c) tests/check.c,$(c:%.c=$(B)/$(1)/%.d) $(c:%.c=$(B)/clang-$(1)/%.d))
endef
# $(1): build folder, $(2): core.
define mps2_image_rule

$(B)/$(1)/mps2/%.elf: $(B)/$(1)/%.o $(B)/$(1)/tests/check.o $(firmware_c:%.c=$(B)/$(1)/%.o) \
    $(mps2_board_c:%.c=$(B)/$(2)/%.o) boards/mps2/board.ld boards/sections.ld
	@mkdir -p $$(@D)
	$$(say) LD $$@
	arm-none-eabi-gcc -mthumb -mcpu=$(2) -nostdlib -nostartfiles -Lboards -T boards/mps2/board.ld \
	    -Wl,--gc-sections,--build-id=none,-z,noexecstack,--no-enum-size-warning,--fatal-warnings -o $$@ $$(filter %.o,$$^) -lgcc
endef
$(foreach c,$(mps2_cores),$(eval $(call mps2_rules,$(c))))

# Every unit test on every core, as gcc compiles it.
define mps2_unit_test
$(B)/check/mps2/$(1).log: $(unit_c:%.c=$(B)/$(1)/mps2/%.elf) tests/mcu/mps2/run.sh FORCE
	@tests/run.sh $$@ tests/mcu/mps2/run.sh $($(1)_machine) $$(filter %.elf,$$^)
endef
$(foreach c,$(mps2_cores),$(eval $(call mps2_unit_test,$(c))))

# The digests, of both compilers, against the host's.
same_bits_cores := $(foreach c,$(mps2_cores),$(c) clang-$(c))
$(B)/check/script/tests/mcu/mps2/same_bits.log: $(foreach v,$(variants),$(digest_c:%.c=$(B)/$(v)/%)) \
    $(foreach v,$(same_bits_cores),$(digest_c:%.c=$(B)/$(v)/mps2/%.elf)) $(firmware_c:%.c=$(B)/cortex-m4/%.o)
# What the runner must not take for a pass.
$(B)/check/script/tests/mcu/mps2/planted.log: \
    $(foreach c,cortex-m0plus cortex-m4,$(mps2_plant_c:%.c=$(B)/$(c)/mps2/%.elf))

test_runs += $(mps2_cores:%=mps2/%) script/tests/mcu/mps2/same_bits script/tests/mcu/mps2/planted
