# The same runs on other processors. Included by the top Makefile.

# WAYS: of tests/processors/run.sh; all without it.
.PHONY: test-processors
test-processors:  ## twelve runs on emulated processors, bit by bit (WAYS='older narrowest AVX2 nehalem arm64')
test-processors: $(SCREED)
	$(if $(filter-out arm64,$(or $(WAYS),arm64)),,+@$(MAKE) --no-print-directory BUILD=arm64 build)
	@SCREED_PROGRAM=$(abspath $(SCREED)) ARM64_PROGRAM=$(abspath $(BUILD_ROOT)/arm64/screed) tests/processors/run.sh \
	  $(WAYS)
