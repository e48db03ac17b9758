# STM32F405RG: Cortex-M4 at 168 MHz, 1 MiB flash, 192 KiB RAM, two CAN controllers.
stm32f405_cpu := cortex-m4
stm32f405_hal := cortexm stm32f4
stm32f405_scene := yes
stm32f405_rig := host-sim/rigs/studio.ini
stm32f405_flash := openocd=target/stm32f4x.cfg st-flash=0x08000000 dfu-util=0483:df11,0x08000000 stm32flash=0x08000000
stm32f405_openocd := target/stm32f4x.cfg
