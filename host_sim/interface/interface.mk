# Screed as C libraries for other programs: shared, static, header, pkg-config. Included by the top Makefile.
#
# Needs host.mk: the libraries are what the program's library holds and their functions need, nothing more.

# Changes when programs that were linked before would no longer run.
SOIL_ABI := 0
SOIL_HEADER := host_sim/interface/screed/soil.h
# One a line, so that what leaves or joins shows.
SOIL_FUNCTIONS := $(shell cat host_sim/interface/soil.symbols)
SOIL_SHARED := $(B)/libscreed-soil.so.$(SOIL_ABI)
SOIL_STATIC := $(B)/libscreed-soil.a
SOIL_PC := $(B)/screed-soil.pc
INTERFACE_LIBRARIES := $(SOIL_SHARED) $(SOIL_STATIC) $(SOIL_PC)
ONLY_NEEDED = -Wl,--gc-sections $(SOIL_FUNCTIONS:%=-Wl,-u,%)

$(B)/soil.map: host_sim/interface/soil.symbols
	@mkdir -p $(@D)
	@echo 'SCREED_SOIL_$(SOIL_ABI) { global: $(SOIL_FUNCTIONS:%=%;) local: *; };' > $@
# What they do not need is dropped with all that it asks for; so no library is named but the compiler's own.
$(SOIL_SHARED): $(LIBRARY) $(B)/soil.map
	@echo "  LINK $@"
	@$(CXX) -shared $(filter -fsanitize%,$(OPTIMISE_$(BUILD))) -Wl,-soname,$(@F) -Wl,--version-script=$(B)/soil.map \
	  -Wl,-z,defs $(ONLY_NEEDED) $(LIBRARY) -o $@
	@ln -sfn $(@F) $(basename $@)
$(SOIL_STATIC): $(LIBRARY) host_sim/interface/soil.symbols
	@echo "  AR   $@"
	@$(CXX) -r -nostdlib $(ONLY_NEEDED) $(LIBRARY) -o $(@:.a=.o)
	@objcopy --wildcard --strip-unneeded $(SOIL_FUNCTIONS:%=--keep-global-symbol=%) $(@:.a=.o)
	@rm -f $@
	@ar rcs $@ $(@:.a=.o)
$(SOIL_PC): host_sim/interface/screed-soil.pc.in FORCE
	@sed 's|@VERSION@|$(firstword $(VERSION_WORDS))|' $< | $(WRITE_CHANGED)

.PHONY: libraries install-libraries test-interface
libraries: $(INTERFACE_LIBRARIES)  ## build/<BUILD>/libscreed-soil, the soil for other programs (C)
INSTALLED_LIBRARIES := include/screed $(addprefix lib/,pkgconfig/$(notdir $(SOIL_PC)) \
  $(notdir $(SOIL_SHARED) $(basename $(SOIL_SHARED)) $(SOIL_STATIC)))
install: install-libraries
install-libraries: $(INTERFACE_LIBRARIES)  ## install the C libraries alone (PREFIX=/usr/local)
	install -D -m 644 -t $(INTO)/include/screed $(SOIL_HEADER)
	install -D -m 644 -t $(INTO)/lib $(SOIL_SHARED) $(SOIL_STATIC)
	ln -sfn $(notdir $(SOIL_SHARED)) $(INTO)/lib/$(notdir $(basename $(SOIL_SHARED)))
	install -D -m 644 -t $(INTO)/lib/pkgconfig $(SOIL_PC)
test-interface: $(INTERFACE_LIBRARIES) $(SCREED)  ## the C libraries as installed: names, examples with ODE and MuJoCo
	@SCREED_PROGRAM=$(abspath $(SCREED)) tests/interface/run.sh
