# A program for 64-bit Arm, made and run on another machine: `make test BUILD=arm64`. Included by options.mk for that
# kind of build.
#
# A cross compiler with Debian's packages for arm64 below build/sysroot; what is linked runs here by qemu-user.

SYSROOT := $(abspath $(BUILD_ROOT))/sysroot/root
CXX := aarch64-linux-gnu-g++ --sysroot=$(SYSROOT)
AR := aarch64-linux-gnu-ar
OBJCOPY := aarch64-linux-gnu-objcopy
export PKG_CONFIG_SYSROOT_DIR := $(SYSROOT)
export PKG_CONFIG_LIBDIR := $(SYSROOT)/usr/lib/aarch64-linux-gnu/pkgconfig:$(SYSROOT)/usr/share/pkgconfig
# $(call runnable,PROGRAM): PROGRAM becomes PROGRAM.elf and a script that runs it. What it starts itself finds its
# libraries too, where the kernel runs arm64 programs by qemu.
define runnable
@mv $(1) $(1).elf
@printf '#!/bin/sh\nexport QEMU_LD_PREFIX=$(SYSROOT)\nexec %s "$$0.elf" "$$@"\n' "$$(command -v qemu-aarch64)" > $(1)
@chmod +x $(1)
endef

$(SYSROOT): tools/arm64/debian.sh tools/debian-packages.txt
	@echo "  GET  packages for arm64"
	@tools/arm64/debian.sh sysroot $(BUILD_ROOT)/sysroot tools/debian-packages.txt
	@touch $@
# Left out of the tests under qemu: they wait until /proc shows that the program handles a signal, and see what qemu
# handles.
export GTEST_FILTER ?= -Interrupt.QuietRunsAreStoppedAsWell:Interrupt.WaitingForARobotIsStoppedAndNoOtherFailure
