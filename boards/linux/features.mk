# Optional libraries of the program on Linux: a feature is on where its header is, and `boresight --version` lists it.
# What is found goes into a header that every file of the host includes; it changes only when the answer does.
find_header = $(firstword $(wildcard $(sysroot)/usr/include/$(1) $(sysroot)/usr/local/include/$(1)))
gpiod_header := $(call find_header,gpiod.h)
# 1.6 and 2.x have the same header's name and no call in common.
gpiod := $(if $(gpiod_header),$(if $(shell grep -l gpiod_line_settings_new $(gpiod_header)),2,1),0)
libusb := $(if $(call find_header,libusb-1.0/libusb.h),1,0)
# What is used of it (jpeg_mem_src, standard tables where a picture has none) is libjpeg-turbo's.
jpeg := $(if $(call find_header,jpeglib.h),1,0)
apriltag := $(if $(call find_header,apriltag/apriltag.h),1,0)
cairo := $(if $(call find_header,cairo/cairo.h),1,0)

feature_libs := $(if $(filter 0,$(gpiod)),,-lgpiod) $(if $(filter 0,$(libusb)),,-lusb-1.0) $(if $(filter 0,$(jpeg)),,-ljpeg) $(if $(filter 0,$(apriltag)),,-lapriltag -lapriltag-utils) $(if $(filter 0,$(cairo)),,-lcairo)
# Files that only build with a library, or one of its versions.
not_built := $(if $(filter 1,$(gpiod)),,hal/linux/linux_gpiod_1.c) $(if $(filter 2,$(gpiod)),,hal/linux/linux_gpiod_2.c) \
    boards/linux/detect/$(if $(filter 0,$(apriltag)),tags,tags_none).c boards/linux/drawing_$(if $(filter 0,$(cairo)),cairo,none).c

$(shell mkdir -p $(B); printf '#define HAVE_GPIOD %s\n#define HAVE_LIBUSB %s\n#define HAVE_JPEG %s\n#define HAVE_APRILTAG %s\n' $(gpiod) $(libusb) $(jpeg) $(apriltag) >$(B)/features.h.new; \
    cmp -s $(B)/features.h.new $(B)/features.h && rm $(B)/features.h.new || mv $(B)/features.h.new $(B)/features.h; \
    echo '$(feature_libs)' >$(B)/features.libs)
