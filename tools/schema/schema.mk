# The schema of the radio's messages and what is made of it. Included by the top Makefile, before the first use of what
# it makes.
#
#   firmware/protocol/screed.dbc -> build/generated/schema/values.h names of values and flags, for the microcontroller
#   and the host
#                                    build/generated/schema/class_values.h  names of values that name classes, likewise
#                                    build/generated/schema/classes.h the headers of classes that values name, likewise
#                                     build/generated/schema/messages.h   pack and unpack, likewise
#                                    build/generated/schema/tables.h     names, units, scales, for the host
#                                    build/generated/wireshark           a profile for Wireshark and tshark
#
# Needs options.mk, and WARNINGS of host.mk when its rules run.

SCHEMA := firmware/protocol/screed.dbc
GENERATED_FOLDER := $(BUILD_ROOT)/generated
SCHEMA_COMPILER := $(BUILD_ROOT)/schema/schema_compiler
SCHEMA_SOURCES := $(call sources,tools/schema)
SCHEMA_OBJECTS := $(SCHEMA_SOURCES:%.cpp=$(BUILD_ROOT)/schema/%.o)
FIRMWARE_SCHEMA_HEADERS := $(addprefix $(GENERATED_FOLDER)/schema/,values.h class_values.h classes.h messages.h)
SCHEMA_HEADERS := $(FIRMWARE_SCHEMA_HEADERS) $(GENERATED_FOLDER)/schema/tables.h

# The compiler is built once for every kind of build, and before everything else.
$(BUILD_ROOT)/schema/%.o: %.cpp tools/schema/schema.mk
	@mkdir -p $(@D)
	@echo "  CXX  $<"
	@$(HERE_CXX) -std=c++20 -O1 $(WARNINGS) -I. -MMD -MP -c $< -o $@
$(SCHEMA_COMPILER): $(SCHEMA_OBJECTS)
	@$(HERE_CXX) $^ -o $@.$$$$ && mv $@.$$$$ $@

# The stamp is new when the compiler has run; the headers only when they changed.
$(GENERATED_FOLDER)/schema.stamp: $(SCHEMA) $(SCHEMA_COMPILER)
	@mkdir -p $(GENERATED_FOLDER)/schema $(GENERATED_FOLDER)/wireshark
	@$(SCHEMA_COMPILER) $(SCHEMA) --values $(GENERATED_FOLDER)/schema/values.h \
	  --class-values $(GENERATED_FOLDER)/schema/class_values.h --classes $(GENERATED_FOLDER)/schema/classes.h \
	  --messages $(GENERATED_FOLDER)/schema/messages.h --tables $(GENERATED_FOLDER)/schema/tables.h \
	  --wireshark $(GENERATED_FOLDER)/wireshark
	@touch $@
$(SCHEMA_HEADERS): $(GENERATED_FOLDER)/schema.stamp ;

# The tables in the page for people.
TELEMETRY_PAGE := docs/telemetry.md
.PHONY: telemetry-page check-telemetry-page
telemetry-page: $(SCHEMA_COMPILER)  ## the tables of docs/telemetry.md anew from the DBC
	@$(SCHEMA_COMPILER) $(SCHEMA) --document $(TELEMETRY_PAGE)
check-telemetry-page: $(SCHEMA_COMPILER)
	@$(SCHEMA_COMPILER) $(SCHEMA) --check-document $(TELEMETRY_PAGE)
