# The page of `screed report`: scripts and style in one file, bundled with three.js and uPlot. Included by the top
# Makefile.
#
# npm takes the packages that package-lock.json names, by their hashes. The page is a product of the build: nothing of
# them is here.

REPORT_SOURCES := $(addprefix tools/report/,package.json package-lock.json build.mjs page.html style.css) \
  $(sort $(wildcard tools/report/src/*.js))
REPORT_PAGE := $(BUILD_ROOT)/report/page.html
REPORT_WORK := $(BUILD_ROOT)/report/work
NPM_CI := npm ci --ignore-scripts --no-audit --no-fund --loglevel=error

.PHONY: report-page
report-page: $(REPORT_PAGE)  ## the page that `screed report` writes runs into (needs npm)
$(REPORT_WORK)/packages: tools/report/package.json tools/report/package-lock.json
	@rm -rf $(REPORT_WORK)
	@mkdir -p $(REPORT_WORK)
	@echo "  NPM  tools/report"
	@cp $^ $(REPORT_WORK)
	@cd $(REPORT_WORK) && $(NPM_CI) > /dev/null
	@touch $@
# A release has the page made: whoever builds it needs neither npm nor a network.
BUILT_PAGE := $(wildcard tools/report/built_page.html)
ifneq ($(BUILT_PAGE),)
$(REPORT_PAGE): $(BUILT_PAGE)
	@install -D -m 644 $< $@
else
$(REPORT_PAGE): $(REPORT_SOURCES) $(REPORT_WORK)/packages
	@echo "  PAGE $@"
	@cp -r $(filter tools/report/%,$(filter-out %.js,$(REPORT_SOURCES))) tools/report/src $(REPORT_WORK)
	@cd $(REPORT_WORK) && node build.mjs ../page.html.new
	@mv $@.new $@
endif
build: $(REPORT_PAGE)
