# Images for microcontroller boards. A board is a folder with a board.mk; boards/README.md explains its variables.
board_mks := $(sort $(wildcard boards/*/board.mk))
mcu_boards := $(board_mks:boards/%/board.mk=%)
include $(board_mks)

# `make firmware BOARD=x RIG=my.ini`: the image for another rig than the board's own.
ifneq ($(BOARD),)
ifneq ($(RIG),)
$(BOARD)_rig := $(RIG)
endif
endif

board_cc := arm-none-eabi-gcc
# Paths in the debug information are relative, so that two folders give the same bytes.
board_flags := $(arm_flags) -Ihal -Iboards -fno-common -ffile-prefix-map=$(CURDIR)=.
board_link := -mthumb -nostdlib -nostartfiles -Lboards \
    -Wl,--gc-sections,--build-id=none,--fatal-warnings,--no-undefined

# $(1): name of the board. Objects are below obj/; a rig's settings are compiled from the C that the program writes.
define board_rules
$(1)_dir := $(B)/boards/$(1)
$(1)_c := boards/greeting.c $(sort $(wildcard boards/$(1)/*.c boards/$(1)/scene/none.c $(foreach h,$($(1)_hal),hal/$(h)/*.c))) $(sort $(firmware_c))
$(1)_s := $(sort $(wildcard boards/$(1)/*.S))
$(1)_o := $$(patsubst %,$(B)/boards/$(1)/obj/%.o,$$(basename $$($(1)_c) $$($(1)_s)) build_id)
$(1)_files := $(foreach i,elf bin hex $($(1)_images),$(B)/boards/$(1)/boresight.$(i))

$(B)/boards/$(1)/obj/build_id.o: $(B)/build_id.c
	@mkdir -p $$(@D)
	$(board_cc) $(board_flags) -mcpu=$($(1)_cpu) -c $$< -o $$@
$(B)/boards/$(1)/obj/%.o: %.c
	@mkdir -p $$(@D)
	$$(say) CC $$@
	$(board_cc) $(board_flags) -mcpu=$($(1)_cpu) -Iboards/$(1) -MMD -MP -c $$< -o $$@
$(B)/boards/$(1)/obj/%.o: %.S
	@mkdir -p $$(@D)
	$$(say) AS $$@
	$(board_cc) $(board_flags) -Wa,--debug-prefix-map=$(CURDIR)=. -mcpu=$($(1)_cpu) -Iboards/$(1) -MMD -MP -c $$< -o $$@
-include $$($(1)_o:.o=.d)

# The board's own rig, and below a folder of its name any other of the simulator's.
$(B)/boards/$(1)/rig.c: $($(1)_rig) $(B)/boresight FORCE
	@mkdir -p $$(@D)
	$$(call write_rig,$$<,$$@)
$(B)/boards/$(1)/%/rig.c: host-sim/rigs/%.ini $(B)/boresight FORCE
	@mkdir -p $$(@D)
	$$(call write_rig,$$<,$$@)
$(B)/boards/$(1)/%rig.o: $(B)/boards/$(1)/%rig.c
	$(board_cc) $(board_flags) -mcpu=$($(1)_cpu) -MMD -MP -c $$< -o $$@
$(B)/boards/$(1)/rig.o: $(B)/boards/$(1)/rig.c
	$(board_cc) $(board_flags) -mcpu=$($(1)_cpu) -MMD -MP -c $$< -o $$@
-include $(wildcard $(B)/boards/$(1)/rig.d $(B)/boards/$(1)/*/rig.d)

$(B)/boards/$(1)/boresight.elf: $(B)/boards/$(1)/rig.o $$($(1)_o) boards/$(1)/board.ld boards/sections.ld
	$$(say) LD $$@
	$(board_cc) $(board_link) -mcpu=$($(1)_cpu) -T boards/$(1)/board.ld -Wl,-Map=$$(@:.elf=.map) \
	    -o $$@ $$(filter %.o,$$^) -lgcc
$(B)/boards/$(1)/%/boresight.elf: $(B)/boards/$(1)/%/rig.o $$($(1)_o) boards/$(1)/board.ld boards/sections.ld
	$$(say) LD $$@
	$(board_cc) $(board_link) -mcpu=$($(1)_cpu) -T boards/$(1)/board.ld -Wl,-Map=$$(@:.elf=.map) \
	    -o $$@ $$(filter %.o,$$^) -lgcc
endef

# $(1): a board with `x_scene := yes`. The same image with a scene in flash, in build/boards/x/$(2)/: from the file $(3), for the rig whose
# settings are in $(4).
define scene_rules
$(B)/boards/$(1)/$(2)/block.coca: $(3) $(B)/boresight
	@mkdir -p $$(@D)
	case $$< in *.coca) cp $$< $$@ ;; *) $(B)/boresight scene build $$< -o $$@ ;; esac
$(B)/boards/$(1)/$(2)/block.o: $(B)/boards/$(1)/$(2)/block.coca
	printf '%s\n' '.section .rodata.scene, "a"' '.balign 4' '.global scene_block, scene_block_end' 'scene_block:' \
	    '.incbin "$$<"' 'scene_block_end:' | arm-none-eabi-as -mcpu=$($(1)_cpu) -o $$@
$(B)/boards/$(1)/$(2)/boresight.elf: $(B)/boards/$(1)/$(2)/block.o $(4) $(B)/boards/$(1)/obj/boards/$(1)/scene/flash.o \
    $$(filter-out %/scene/none.o,$$($(1)_o)) boards/$(1)/scene/scene.ld boards/$(1)/memory.ld boards/sections.ld
	$$(say) LD $$@
	$(board_cc) $(board_link) -mcpu=$($(1)_cpu) -T boards/$(1)/scene/scene.ld -Wl,-Map=$$(@:.elf=.map) \
	    -o $$@ $$(filter %.o,$$^) -lgcc
endef
scene_boards := $(foreach b,$(mcu_boards),$(if $(filter yes,$($(b)_scene)),$(b)))
# The scene that the tests flash.
$(B)/boards/park.scene: tests/mcu/cpu/park.awk
	@mkdir -p $(@D)
	awk -f $< >$@

write_rig = $(B)/boresight config c $(1) >$(2).new && if cmp -s $(2).new $(2); then rm $(2).new; else mv $(2).new $(2); fi
$(foreach b,$(mcu_boards),$(eval $(call board_rules,$(b))))
# From SCENE=FILE.scene or FILE.coca.
$(foreach b,$(scene_boards),$(eval $(b)_scene_files := $(foreach i,elf bin hex,$(B)/boards/$(b)/scene/boresight.$(i))) \
    $(eval $(call scene_rules,$(b),scene,$(or $(SCENE),$(B)/boards/park.scene),$(B)/boards/$(b)/rig.o)))

$(B)/boards/%.bin: $(B)/boards/%.elf
	arm-none-eabi-objcopy -O binary $< $@
$(B)/boards/%.hex: $(B)/boards/%.elf
	arm-none-eabi-objcopy -O ihex $< $@

# ---------------------------------------------------------------- targets
.PHONY: firmware flash debug stack need-firmware board-named
board-named:
	@case ' $(mcu_boards) ' in *' $(or $(BOARD),none) '*) ;; *) \
	    echo 'Which board? BOARD=NAME, one of: $(mcu_boards)' >&2; exit 2 ;; esac
	@[ -z '$(SCENE)' ] || [ -r '$(SCENE)' ] || { echo 'SCENE=$(SCENE): no such file' >&2; exit 2; }
	@[ -z '$(SCENE)' ] || [ '$(filter $(BOARD),$(scene_boards))' ] || { echo 'SCENE= is only for $(strip $(scene_boards))' >&2; exit 2; }
	@[ -z '$(RIG)' ] || [ -r '$(RIG)' ] || { echo 'RIG=$(RIG): no such file' >&2; exit 2; }
need-firmware: board-named
	@.ci/need firmware

# With SCENE= the plain image is built, too, so that what the scene takes is told apart.
firmware: need-firmware ## Build the image of BOARD=x, print what it needs of the board (RIG=my.ini: another rig; SCENE=my.scene: with a scene)
	@$(MAKE) --no-print-directory $($(BOARD)_files) $(if $(SCENE),$($(BOARD)_scene_files))
	tests/gate/check/budget.sh $(B)/boards/$(BOARD)/boresight.elf
	echo
	$(if $(SCENE),tests/gate/check/scene-size.sh $(B)/boards/$(BOARD) && echo)
	ls -l $($(BOARD)_files) $(if $(SCENE),$($(BOARD)_scene_files)) | awk '{ printf "%9d bytes  %s\n", $$5, $$NF }'

flash: need-firmware ## Write the image of BOARD=x to the board, with the tool that fits what is connected
	@$(MAKE) --no-print-directory $(if $(SCENE),$($(BOARD)_scene_files),$($(BOARD)_files))
	boards/flash.sh $(BOARD) $(B)/boards/$(BOARD)/$(if $(SCENE),scene/)boresight $($(BOARD)_flash)

debug: need-firmware ## Open gdb on the board (BOARD=x) through openocd
	@$(MAKE) --no-print-directory $($(BOARD)_files)
	boards/debug.sh $(B)/boards/$(BOARD)/boresight.elf $($(BOARD)_openocd)

stack: need-firmware ## Print the deepest chain of calls of BOARD=x, and the stack that it takes
	@$(MAKE) --no-print-directory $($(BOARD)_files)
	tests/gate/check/callgraph.sh $(B)/boards/$(BOARD)/boresight.elf

# For the gate that plants a difference (tests/gate/reproducible.sh).
.PHONY: print-board-flags
print-board-flags:
	@echo '$(board_flags)'
