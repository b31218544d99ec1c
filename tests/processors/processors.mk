# The same runs on other processors. Included by the top Makefile.

# WAYS: of tests/processors/run.sh; all without it.
WITH_ARM64 := $(filter arm64,$(or $(WAYS),arm64))
# Python and NumPy for arm64.
PYTHON_ARM64 := $(abspath $(BUILD_ROOT))/python_arm64/root
$(PYTHON_ARM64): tools/arm64/debian.sh tests/python/debian-packages.txt
	@echo "  GET  Python for arm64"
	@tools/arm64/debian.sh sysroot $(@D) tests/python/debian-packages.txt
	@touch $@
.PHONY: test-processors
test-processors:  ## runs on emulated processors, bit by bit (WAYS='older narrowest AVX2 nehalem arm64')
test-processors: $(SCREED) $(INTERFACE_LIBRARIES) $(if $(WITH_ARM64),$(PYTHON_ARM64))
	$(if $(WITH_ARM64),+@$(MAKE) --no-print-directory BUILD=arm64 build libraries)
	@RELEASE=$(abspath $(B)) ARM64=$(abspath $(BUILD_ROOT)/arm64) PYTHON_ARM64=$(PYTHON_ARM64) \
	  SYSROOT=$(abspath $(BUILD_ROOT))/sysroot/root tests/processors/run.sh $(WAYS)
