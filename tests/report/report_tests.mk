# The page of `screed report` in a headless Chromium. Included by the top Makefile.

REPORT_TEST_WORK := $(BUILD_ROOT)/report/test

.PHONY: test-report
test-report:  ## pages of runs in a headless browser, MCAP files (needs npm, chromium)
test-report: $(SCREED) $(REPORT_PAGE) $(REPORT_TEST_WORK)/packages
	@cp tests/report/*.mjs $(REPORT_TEST_WORK)
	@runs=$$(mktemp -d) && trap 'rm -rf "$$runs"' EXIT && \
	  node $(REPORT_TEST_WORK)/report_test.mjs $(abspath $(SCREED)) "$$runs"
$(REPORT_TEST_WORK)/packages: tests/report/package.json tests/report/package-lock.json
	@rm -rf $(REPORT_TEST_WORK)
	@mkdir -p $(REPORT_TEST_WORK)
	@echo "  NPM  tests/report"
	@cp $^ $(REPORT_TEST_WORK)
	@cd $(REPORT_TEST_WORK) && $(NPM_CI) > /dev/null
	@touch $@
