# Raspberry Pi Pico (RP2040): Cortex-M0+ at 125 MHz, 2 MiB flash, 264 KiB RAM. Hobby servos by pulse width.
pico_cpu := cortex-m0plus
pico_hal := cortexm rp2040
pico_rig := host-sim/rigs/hobby.ini
pico_images := uf2
pico_flash := uf2=RPI-RP2 openocd=target/rp2040.cfg
pico_openocd := target/rp2040.cfg

$(B)/boards/pico/uf2-writer: boards/pico/uf2/uf2.c
	@mkdir -p $(@D)
	$(say) CC $@
	gcc $(common) -O2 -o $@ $<
$(B)/boards/pico/%.uf2: $(B)/boards/pico/%.bin $(B)/boards/pico/uf2-writer
	$(B)/boards/pico/uf2-writer $< $@
