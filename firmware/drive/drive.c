#include "drive/drive.h"

#include "drive/rmd.h"
#include "fixed/q30.h"
#include "motion/axis.h"

