# Screed as C libraries for other programs: shared, static, headers, pkg-config. Included by the top Makefile.
#
# Needs host.mk: the libraries are what the program's library holds and their functions need, nothing more.

# Changes when programs that were linked before would no longer run.
INTERFACE_ABI := 0
# Where libraries lie below PREFIX (lib/x86_64-linux-gnu), and the way back from their pkg-config files.
LIBDIR = lib
$(if $(filter /%,$(LIBDIR)),$(error LIBDIR=$(LIBDIR): is a folder below PREFIX))
PC_UP := $(subst $(empty) ,/,$(patsubst %,..,$(subst /, ,$(LIBDIR)/pkgconfig)))
INTERFACE_HEADERS := $(wildcard host_sim/interface/screed/*.h)
# NAME.symbols: the functions of libNAME, one a line, so that what leaves or joins shows.
INTERFACE_NAMES := screed-soil screed-core screed
symbols_of = $(shell cat host_sim/interface/$(1).symbols)
# No image is run by them: simavr would bring its licence.
INTERFACE_OBJECTS := $(if $(filter yes,$(MCU)),$(B)/host_sim/run/world/without_simavr.o) $(LIBRARY)
# What they do not need is dropped with all that it asks for; so the small ones need no library but the compiler's own.
interface_libraries_screed = $$(sed 's|-lsimavr||; s|-lode|$(ODE_WITHIN) $(ODE_NEEDS)|' $(B)/link.flags)
only_needed = -Wl,--gc-sections $(patsubst %,-Wl$(comma)-u$(comma)%,$(call symbols_of,$(1)))

# ODE as a part of libscreed: it calls the sines that are defined there, as in the program; a shared one would call
# those of the C library, whose bits depend on the processor. Debian's static one is made for programs: within a
# shared library it may not hold the address of the C library's stdout, so it gets variables of ours (ode_world.cpp).
ODE_WITHIN := $(or $(ODE),$(B)/ode/libode.a)
# What Debian's ODE tells convex bodies apart with.
ODE_NEEDS := $(if $(ODE),,-l:libccd.so.2)
$(B)/ode/libode.a:
	@mkdir -p $(@D)
	@$(OBJCOPY) --redefine-sym stdout=screed_stdout --redefine-sym stderr=screed_stderr \
	  "$$(pkg-config --variable=libdir ode)/libode.a" $@
$(B)/libscreed.so.$(INTERFACE_ABI): $(ODE_WITHIN)
SANITIZERS := $(filter -fsanitize%,$(OPTIMISE_$(BUILD)))
SANITIZERS += $(if $(SANITIZERS),-shared-libsan)
define interface_library
$(B)/$(1).map: host_sim/interface/$(1).symbols
	@mkdir -p $$(@D)
	@echo 'SCREED_$(INTERFACE_ABI) { global: $$(patsubst %,%;,$$(call symbols_of,$(1))) local: *; };' > $$@
$(B)/lib$(1).so.$(INTERFACE_ABI): $(INTERFACE_OBJECTS) $(B)/$(1).map $(B)/link.flags
	@echo "  LINK $$@"
	@$$(CXX) -shared $(SANITIZERS) -Wl,-soname,$$(@F) -Wl,--version-script=$(B)/$(1).map -Wl,-z,defs \
	  $$(call only_needed,$(1)) $(INTERFACE_OBJECTS) -Wl,--as-needed $$(interface_libraries_$(1)) -o $$@
	@ln -sfn $$(@F) $$(basename $$@)
$(B)/$(1).pc: host_sim/interface/screed.pc.in FORCE
	@sed 's|@NAME@|$(1)|; s|@VERSION@|$(firstword $(VERSION_WORDS))|; s|@UP@|$(PC_UP)|' $$< | $$(WRITE_CHANGED)
endef
$(foreach name,$(INTERFACE_NAMES),$(eval $(call interface_library,$(name))))
define interface_archive
$(B)/lib$(1).a: $(INTERFACE_OBJECTS) host_sim/interface/$(1).symbols
	@echo "  AR   $$@"
	@$$(CXX) -r -nostdlib $$(call only_needed,$(1)) $(INTERFACE_OBJECTS) -o $$(@:.a=.o)
	@$$(OBJCOPY) --strip-unneeded $$(addprefix --keep-global-symbol=,$$(call symbols_of,$(1))) $$(@:.a=.o)
	@rm -f $$@
	@$$(AR) rcs $$@ $$(@:.a=.o)
endef
INTERFACE_ARCHIVES := screed-soil screed-core
$(foreach name,$(INTERFACE_ARCHIVES),$(eval $(call interface_archive,$(name))))
INTERFACE_SHARED := $(INTERFACE_NAMES:%=$(B)/lib%.so.$(INTERFACE_ABI))
INTERFACE_STATIC := $(INTERFACE_ARCHIVES:%=$(B)/lib%.a)
INTERFACE_PC := $(INTERFACE_NAMES:%=$(B)/%.pc)
INTERFACE_LIBRARIES := $(INTERFACE_SHARED) $(INTERFACE_STATIC) $(INTERFACE_PC)

.PHONY: libraries install-libraries test-interface
libraries: $(INTERFACE_LIBRARIES)  ## build/<BUILD>/libscreed-soil, -core and libscreed, for other programs (C)
INSTALLED_MODULE := lib/python3/dist-packages/screed
INSTALLED_LIBRARIES := $(INSTALLED_MODULE) include/screed \
  $(addprefix $(LIBDIR)/,$(addprefix pkgconfig/,$(notdir $(INTERFACE_PC))) \
  $(notdir $(INTERFACE_SHARED) $(basename $(INTERFACE_SHARED)) $(INTERFACE_STATIC)))
install: install-libraries
install-libraries: $(INTERFACE_LIBRARIES)  ## install the C libraries and the Python module alone (PREFIX=/usr/local)
	install -D -m 644 -t $(INTO)/include/screed $(INTERFACE_HEADERS)
	install -D -m 644 -t $(INTO)/$(LIBDIR) $(INTERFACE_SHARED) $(INTERFACE_STATIC)
	for it in $(notdir $(INTERFACE_SHARED)) ; do ln -sfn $$it $(INTO)/$(LIBDIR)/$${it%.*} ; done
	install -D -m 644 -t $(INTO)/$(LIBDIR)/pkgconfig $(INTERFACE_PC)
	install -D -m 644 -t $(INTO)/$(INSTALLED_MODULE) $(wildcard tools/python/screed/*.py)
test-interface: $(INTERFACE_LIBRARIES) $(SCREED)  ## the C libraries as installed: names, examples with ODE and MuJoCo
	@SCREED_PROGRAM=$(abspath $(SCREED)) tests/interface/run.sh
