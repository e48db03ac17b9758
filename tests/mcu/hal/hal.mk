# The contract suites on the drivers of the STM32F405: an image for the emulated chip (tests/mcu/hal/suites.c).
hal_suite_board := $(B)/boards/stm32f405/obj
hal_suite_c := tests/mcu/hal/suites.c tests/check.c \
    $(foreach s,contract can_suite clock_suite gpio_suite pwm_suite serial_suite,tests/contract/support/$(s).c)
hal_suite_o := $(hal_suite_c:%.c=$(B)/mcu/hal/%.o)

$(B)/mcu/hal/%.o: %.c
	@mkdir -p $(@D)
	$(say) CC $@
	arm-none-eabi-gcc $(arm_flags) -Ihal -Itests -Itests/mcu/hal/libc -Iboards -Iboards/stm32f405 -mcpu=cortex-m4 -MMD -MP -c $< -o $@
-include $(hal_suite_o:.o=.d)

# Interrupt handlers and drivers are those of the board's image, its main() is not.
$(B)/mcu/hal/suites.elf: $(hal_suite_o) $(hal_suite_board)/boards/stm32f405/vectors.o \
    $(patsubst %.c,$(hal_suite_board)/%.o,$(wildcard hal/cortexm/*.c hal/stm32f4/*.c)) boards/stm32f405/board.ld boards/sections.ld
	$(say) LD $@
	arm-none-eabi-gcc $(board_link) -mcpu=cortex-m4 -T boards/stm32f405/board.ld -o $@ $(filter %.o,$^) -lgcc

$(B)/check/gcc/tests/mcu/cpu/hal_contract.log: $(B)/mcu/hal/suites.elf
