# The emulated microcontroller board: the program boresight-mcu, which links libunicorn (GPL), and its tests.
mcu_c := $(wildcard host-sim/mcu/*.c)
mcu_test_c := $(wildcard tests/mcu/*.c)

# libunicorn shows all symbols of the QEMU inside it, and calls ours of the same name (cpu_reset) unless they are hidden.
mcu_link := -Wl,--exclude-libs,ALL

define mcu_rules
$(B)/$(1)/libmcu.a: $(patsubst %.c,$(B)/$(1)/%.o,$(filter-out host-sim/mcu/program.c host-sim/mcu/quick_stores.c,$(mcu_c)))
# quick_stores.o is in no archive: it must be seen by libunicorn.
$(B)/$(1)/boresight-mcu: $(B)/$(1)/boards/linux/main.o $(B)/$(1)/host-sim/mcu/program.o \
    $(B)/$(1)/host-sim/mcu/quick_stores.o $(B)/$(1)/libmcu.a $$($(1)_libs)
	$$(say) LD $$@
	$$($(1)_cc) $$($(1)_ld) $(mcu_link) -o $$@ $$^ -lunicorn -ljansson -lm
$(mcu_test_c:%.c=$(B)/$(1)/%): $(B)/$(1)/tests/mcu/%: $(B)/$(1)/tests/mcu/%.o $(B)/$(1)/libtest.a \
    $(B)/$(1)/host-sim/mcu/quick_stores.o $(B)/$(1)/libmcu.a $$($(1)_libs)
	$$(say) LD $$@
	$$($(1)_cc) $$($(1)_ld) $(mcu_link) -o $$@ $$^ -Wl,--as-needed -lunicorn -ljansson -lm
-include $(patsubst %.c,$(B)/$(1)/%.d,$(mcu_c) $(mcu_test_c))
endef
$(foreach v,$(variants),$(eval $(call mcu_rules,$(v))))

$(B)/boresight-mcu: $(B)/gcc/boresight-mcu
	@cp $< $@

# Programs that run on the emulated processor in the tests: one file each, with a start-up of their own.
guest_c := $(wildcard tests/mcu/guest/*.c)
guest_flags := -std=c11 -O2 -g $(warnings) -ffreestanding -ffunction-sections -mcpu=cortex-m4 -mthumb \
    -mfloat-abi=soft -Itests/mcu/guest
$(B)/guest/%.elf: tests/mcu/guest/%.c tests/mcu/guest/start.c $(wildcard tests/mcu/guest/*.h) tests/mcu/guest/guest.ld
	@mkdir -p $(@D)
	$(say) LD $@
	arm-none-eabi-gcc $(guest_flags) -nostdlib -nostartfiles -Wl,--gc-sections,--build-id=none,--no-warn-rwx-segments \
	    -T tests/mcu/guest/guest.ld -o $@ $(filter %.c,$^) -lgcc
guests := $(patsubst tests/mcu/guest/%.c,$(B)/guest/%.elf,$(filter-out %/start.c,$(guest_c)))
