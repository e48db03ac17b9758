# The image that counts the instructions of a control tick: the STM32F405's objects on QEMU's MPS2 board (tests/mcu/tick/tick.c).
tick_board := $(B)/boards/stm32f405
tick_o := $(tick_board)/rig.o $(tick_board)/obj/hal/cortexm/cortexm_memory.o \
    $(firmware_c:%.c=$(tick_board)/obj/%.o) $(patsubst %.c,$(B)/cortex-m4/%.o,$(wildcard boards/mps2/*.c))

$(B)/mcu/tick/%.o: tests/mcu/tick/%.c
	@mkdir -p $(@D)
	$(say) CC $@
	arm-none-eabi-gcc $(mps2_flags) -Iboards -mcpu=cortex-m4 -MMD -MP -c $< -o $@
-include $(B)/mcu/tick/tick.d $(B)/mcu/tick/plant.d

$(B)/mcu/tick/tick.elf: $(B)/mcu/tick/tick.o
$(B)/mcu/tick/planted.elf: $(B)/mcu/tick/tick.o $(B)/mcu/tick/plant.o
$(B)/mcu/tick/planted.elf: tick_wrap := -Wl,--wrap=framing_follow
$(B)/mcu/tick/tick.elf $(B)/mcu/tick/planted.elf: $(tick_o) boards/mps2/board.ld boards/sections.ld
	$(say) LD $@
	arm-none-eabi-gcc -mthumb -mcpu=cortex-m4 -nostdlib -nostartfiles -Lboards -T boards/mps2/board.ld \
	    -Wl,--gc-sections,--build-id=none,-z,noexecstack,--fatal-warnings $(tick_wrap) -o $@ $(filter %.o,$^) -lgcc

$(B)/check/script/tests/gate/tick.log: $(B)/mcu/tick/tick.elf $(B)/mcu/tick/planted.elf

# Ten points, on the processors of tests/mcu/mps2/.
$(B)/check/script/tests/gate/cone.log: $(foreach c,cortex-m0plus cortex-m4,$(B)/$(c)/mps2/tests/mcu/tick/ten.elf) $(B)/gcc/tests/mcu/tick/ten
