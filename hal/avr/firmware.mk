# The image for the robot's microcontroller, and its budget. Included by the top Makefile.
#
#   build/firmware/<board>/screed.elf and .hex, and their budget of flash, RAM, stack and cycles
#   build/firmware/<board>_usb_core/ the same with USB=core: on the Arduino core's main() and USB instead of hal/avr/usb
#   build/firmware/<board>_node_3/ the same with NODE=3: of the robot that is node 3 on the radio
#   build/firmware/<board>_strokes/ the same with LEVELING=strokes: that is its default algorithm
#
# Needs options.mk and host.mk. A board is a folder boards/<board> with board.h, pins.h and board.mk (docs/boards.md).

include boards/$(BOARD)/board.mk

AVR_CC ?= avr-gcc
AVR_CXX ?= avr-g++
AVR_LD ?= avr-ld
AVR_OBJCOPY ?= avr-objcopy
AVR_OBJDUMP ?= avr-objdump
AVR_SIZE ?= avr-size
AVR_NM ?= avr-nm

# Most flash and RAM a program may use, and what of it must stay free; RAM counts variables and the worst-case stack.
# With USB=core none of flash.
FLASH_BUDGET := 28672
RAM_BUDGET := 2560
RAM_SPARE := 256
FLASH_SPARE_own := 2048
FLASH_SPARE_core := 0
# Where the core writes the bootloader's key while the program still runs (MAGIC_KEY_POS in its USBCore.h).
BOOT_KEY_ADDRESS := 0x0800
# Half of a tick.
TICK_BUDGET_CYCLES := 80000

USB ?= own
USB_FOLDER_own := hal/avr/usb
USB_FOLDER_core := hal/avr/arduino
ifeq ($(USB_FOLDER_$(USB)),)
$(error USB=$(USB): own or core)
endif
USB_SUFFIX_core := _usb_core
FIRMWARE_BUILD := $(BUILD_ROOT)/firmware/$(BOARD)$(USB_SUFFIX_$(USB))$(NODE:%=_node_%)$(LEVELING:%=_%)
FIRMWARE_ELF := $(FIRMWARE_BUILD)/screed.elf
FIRMWARE_SOURCES := $(filter-out hal/avr/usb/% hal/avr/arduino/%,$(call sources,firmware nn/infer hal/avr)) \
  $(call sources,$(USB_FOLDER_$(USB)))
FIRMWARE_STARTUP := $(FIRMWARE_BUILD)/hal/avr/startup.o
FIRMWARE_OBJECTS := $(FIRMWARE_STARTUP) $(FIRMWARE_SOURCES:%.cpp=$(FIRMWARE_BUILD)/%.o)

# No jump tables: they are indirect jumps, which the stack analysis refuses. -mrelax, -mstrict-X and -mcall-prologues
# make the code smaller.
# -fno-toplevel-reorder: functions lie in the order of the sources, so callers lie near what they call (a call within 4
# kB is 2 bytes shorter).
# Optimisations of gcc-avr 5.4 that make the image larger (docs/firmware-budget.md). The Arduino library names them too.
SMALLER := no-gcse no-move-loop-invariants no-tree-loop-im no-tree-dominator-opts no-tree-tail-merge no-tree-ter \
  no-ipa-cp no-ipa-sra
# -g: `make size` names the sources; nothing of it is flashed.
AVR_FLAGS := -std=c++14 -Os -g -mmcu=$(BOARD_MCU) -DF_CPU=$(BOARD_CLOCK_HZ)UL -flto -fno-fat-lto-objects \
  -fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-jump-tables -ffunction-sections -fdata-sections \
  -mrelax -mstrict-X -mcall-prologues -fno-toplevel-reorder $(SMALLER:%=-f%)
# make firmware STANDALONE=yes: the default of the parameter `standalone` is 1.
ifeq ($(STANDALONE),yes)
AVR_FLAGS += -DSCREED_STANDALONE=1
endif
# make firmware NODE=3: the robot's number on the radio, 1 (the default) to 15.
ifdef NODE
AVR_FLAGS += -DSCREED_NODE=$(NODE)
endif
# make firmware LEVELING=NAME: the image whose default algorithm is that one; it has no other but `drive`, unless
# LEAVE_OUT says so.
ALGORITHM_NUMBERS := $(shell sed -nE 's/^VAL_ [0-9]+ algorithm //p' $(SCHEMA) | \
  sed -E 's/([0-9]+) "(\w+)"/\2=\1/g; s/;//')
ifdef LEVELING
ALGORITHMS := $(foreach it,$(ALGORITHM_NUMBERS),$(firstword $(subst =, ,$(it))))
ifneq ($(filter $(LEVELING),$(filter-out drive,$(ALGORITHMS))) 1,$(LEVELING) $(words $(LEVELING)))
$(error LEVELING=$(LEVELING): one of $(filter-out drive,$(ALGORITHMS)))
endif
AVR_FLAGS += -DSCREED_DEFAULT_ALGORITHM=$(patsubst $(LEVELING)=%,%,$(filter $(LEVELING)=%,$(ALGORITHM_NUMBERS)))
LEAVE_OUT ?= $(filter-out drive $(LEVELING),$(ALGORITHMS))
endif
# make firmware LEAVE_OUT="NAME...": the image without these leveling algorithms; unset: as
# firmware/parameters/algorithms_in_build.h says.
# The core writes its key where the RAM of strokes would lie.
ifeq ($(USB)$(LEVELING),core)
LEAVE_OUT ?= training_drive peak_memory strokes
endif
ifneq ($(origin LEAVE_OUT),undefined)
AVR_FLAGS += -DSCREED_LEAVE_OUT='"$(LEAVE_OUT)"'
endif
AVR_WARNINGS := -Wall -Wextra -Wconversion -Wshadow -Werror
AVR_INCLUDES := -I. -Iboards/$(BOARD) -I$(FIRMWARE_BUILD)/generated -I$(BUILD_ROOT)/generated
# Start-up code of our own (hal/avr/startup.S), vectors up to that of the TWI.
LAST_VECTOR := 36
AVR_LINK := -Wl,--gc-sections -nostartfiles
# The image without the core has no variable with a first value other than zero: it needs no loop that copies such. The
# linker refuses one.
AVR_LINK_own := -Wl,--defsym=__do_copy_data=0
# The order of the functions in the image: near what they call. The linker's own script with the list of their sections
# before the others; a function that is not on it comes behind them. `make function-order` makes it anew.
FUNCTION_ORDER := hal/avr/function_order.txt
LINKER_SCRIPT := $(FIRMWARE_BUILD)/screed.ld
AVR_EMULATION := avr5

# The Arduino core of Debian's package arduino-core-avr, with USB=core: main(), USB and the serial line over it. Only
# what is used of it reaches the image.
ARDUINO_ROOT ?= /usr/share/arduino/hardware/arduino/avr
ARDUINO_CORE := $(ARDUINO_ROOT)/cores/arduino
ARDUINO_VARIANT := $(ARDUINO_ROOT)/variants/leonardo
ARDUINO_SOURCES := CDC.cpp PluggableUSB.cpp USBCore.cpp main.cpp Print.cpp Stream.cpp abi.cpp hooks.c
ARDUINO_OBJECTS_core := $(patsubst %,$(FIRMWARE_BUILD)/arduino/%.o,$(ARDUINO_SOURCES))
ARDUINO_FLAGS := -DARDUINO=10819 -DARDUINO_AVR_A_STAR_32U4 -DARDUINO_ARCH_AVR \
  -DUSB_VID=$(BOARD_USB_VID) -DUSB_PID=$(BOARD_USB_PID) -DUSB_MANUFACTURER='"$(BOARD_USB_MANUFACTURER)"' \
  -DUSB_PRODUCT='"$(BOARD_USB_PRODUCT)"' -I$(ARDUINO_CORE) -I$(ARDUINO_VARIANT)

.PHONY: firmware size firmware-budget firmware-algorithms function-order
firmware:  ## build the image for the robot (BOARD=NAME, a folder in boards/)
firmware: $(FIRMWARE_BUILD)/screed.hex firmware-budget firmware-algorithms

# What the analysis cannot see with USB=core: targets of indirect calls. Its "never" lines hold as long as the core's
# serial line is the only object with virtual functions. The image without the core has neither.
INDIRECT_CALLS := hal/avr/arduino/indirect_calls.txt
ALLOWED_VTABLES_core := Serial_
STACK_OPTIONS_core := --indirect-calls $(INDIRECT_CALLS) --free-word $(BOOT_KEY_ADDRESS)

firmware-budget: $(FIRMWARE_BUILD)/screed.lst $(FIRMWARE_BUILD)/screed.size $(B)/avr_stack
	@echo "$(FIRMWARE_ELF)"
	@foreign=$$($(AVR_NM) -C $(FIRMWARE_ELF) | sed -n 's/.*vtable for //p' | \
	  { grep -vxF '$(or $(ALLOWED_VTABLES_$(USB)),none)' || [ $$? -eq 1 ] ; }) ; \
	  [ -z "$$foreign" ] || \
	  { echo "$(FIRMWARE_ELF): virtual functions of $$foreign, which the stack analysis does not know" >&2 ; exit 1 ; }
	@$(B)/avr_stack $(FIRMWARE_BUILD)/screed.lst --sizes $(FIRMWARE_BUILD)/screed.size \
	  $(STACK_OPTIONS_$(USB)) --flash-budget $(FLASH_BUDGET) --flash-spare $(FLASH_SPARE_$(USB)) \
	  --ram-budget $(RAM_BUDGET) --ram-spare $(RAM_SPARE)

# The ELF file lists them, a bit each (hal/avr/hal.cpp).
firmware-algorithms: $(FIRMWARE_ELF)
	@bits=$$($(AVR_OBJCOPY) -O binary --set-section-flags .screed.algorithms=alloc -j .screed.algorithms $< /dev/stdout | \
	    od -An -tu2) ; \
	  has="" ; for it in $(ALGORITHM_NUMBERS) ; do [ $$(( bits >> $${it#*=} & 1 )) -eq 0 ] || has="$$has $${it%=*}" ; \
	  done ; \
	  echo "leveling algorithms       $${has# }"

# Bytes of each module; longest tick and interrupts, measured in the simulator while the robot drives.
size:  ## flash by modules, RAM, stack, longest tick of that image, their reserve
size: firmware-budget $(FIRMWARE_ELF) $(B)/avr_cycles
	@tools/avr/modules.sh $(FIRMWARE_ELF)
	@$(B)/avr_cycles $(FIRMWARE_ELF) boards/$(BOARD)/wiring.ini --budget $(TICK_BUDGET_CYCLES)
$(B)/avr_cycles: $(B)/tools/avr/cycles/main.o $(LIBRARY) $(B)/link.flags
	$(call link)

AVR_TOOL_SOURCES := $(filter-out %/main.cpp,$(call sources,tools/avr/stack) $(call sources,tools/avr/order))
$(B)/libavr_tools.a: $(call objects,$(AVR_TOOL_SOURCES))
	@rm -f $@
	@ar rcs $@ $^
$(B)/avr_stack: $(B)/tools/avr/stack/main.o $(B)/libavr_tools.a $(COMMAND_LINE) $(B)/link.flags
	$(call link)

# Changes only when compiler or flags do, and then everything is built anew.
define AVR_FLAGS_TEXT
$(AVR_CXX) $(AVR_FLAGS) $(AVR_WARNINGS) $(AVR_INCLUDES) $(AVR_LINK) $(AVR_LINK_$(USB)) $(ARDUINO_FLAGS) $(LAST_VECTOR)
endef
$(FIRMWARE_BUILD)/avr.flags: FORCE
	$(shell mkdir -p $(@D))$(file > $@.new,$(AVR_FLAGS_TEXT))
	@cmp -s $@.new $@ && rm $@.new || mv $@.new $@

$(FIRMWARE_BUILD)/generated/build_info.h: FORCE
	@mkdir -p $(@D)
	@{ echo '#define SCREED_VERSION "$(COMMIT)"' ; echo '#define SCREED_BOARD "$(BOARD)"' ; \
	   echo '#define SCREED_USB_VID $(BOARD_USB_VID)' ; echo '#define SCREED_USB_PID $(BOARD_USB_PID)' ; \
	   echo '#define SCREED_USB_MANUFACTURER "$(BOARD_USB_MANUFACTURER)"' ; \
	   echo '#define SCREED_USB_PRODUCT "$(BOARD_USB_PRODUCT)"' ; } > $@.new
	@cmp -s $@.new $@ && rm $@.new || mv $@.new $@

$(FIRMWARE_BUILD)/%.o: %.cpp $(FIRMWARE_BUILD)/avr.flags | $(FIRMWARE_BUILD)/generated/build_info.h $(SCHEMA_HEADERS)
	@mkdir -p $(@D)
	@echo "  AVR  $<"
	@$(AVR_CXX) $(AVR_FLAGS) $(AVR_WARNINGS) $(AVR_INCLUDES) $(ARDUINO_FLAGS) -MMD -MP -c $< -o $@

$(FIRMWARE_BUILD)/%.o: %.S $(FIRMWARE_BUILD)/avr.flags
	@mkdir -p $(@D)
	@echo "  AVR  $<"
	@$(AVR_CC) -mmcu=$(BOARD_MCU) -DLAST_VECTOR=$(LAST_VECTOR) -MMD -MP -c $< -o $@

$(FIRMWARE_BUILD)/arduino/%.cpp.o: $(ARDUINO_CORE)/%.cpp $(FIRMWARE_BUILD)/avr.flags
	@mkdir -p $(@D)
	@$(AVR_CXX) $(AVR_FLAGS) -std=gnu++11 -w $(ARDUINO_FLAGS) -c $< -o $@
$(FIRMWARE_BUILD)/arduino/%.c.o: $(ARDUINO_CORE)/%.c $(FIRMWARE_BUILD)/avr.flags
	@mkdir -p $(@D)
	@$(AVR_CC) $(patsubst -std=%,-std=gnu11,$(filter-out -fno-rtti -fno-threadsafe-statics,$(AVR_FLAGS))) -w \
	  $(ARDUINO_FLAGS) -c $< -o $@

$(FIRMWARE_ELF): $(FIRMWARE_OBJECTS) $(ARDUINO_OBJECTS_$(USB)) $(LINKER_SCRIPT)
	@echo "  LINK $@"
	@$(AVR_CXX) $(AVR_FLAGS) $(AVR_WARNINGS) $(AVR_LINK) $(AVR_LINK_$(USB)) -Wl,-T,$(LINKER_SCRIPT) \
	  -Wl,-Map,$(@:.elf=.map) $(filter %.o,$^) -o $@

$(LINKER_SCRIPT): $(FUNCTION_ORDER) $(FIRMWARE_BUILD)/avr.flags
	@$(AVR_LD) -m $(AVR_EMULATION) --verbose | awk -v list=$< ' \
	  /^=====/ {inside = !inside; next} !inside {next} \
	  !done && /^ *\*\(\.text\)/ {while ((getline name < list) > 0) if (name !~ /^#/) print "    *(" name ")"; done = 1} \
	  {print} \
	  END {if (!done) {print "the linker script has no *(.text)" > "/dev/stderr"; exit 1}}' > $@
	@for number in $$(seq $$(($(LAST_VECTOR) + 1)) 63) ; do \
	   echo "ASSERT(!DEFINED(__vector_$$number), \"an interrupt handler beyond LAST_VECTOR of hal/avr/firmware.mk\")" ; \
	   done >> $@
	@[ $(USB) = core ] || \
	  echo 'ASSERT(SIZEOF(.data) == 0, "a variable with a first value, which nothing copies: AVR_LINK_own")' >> $@

function-order:  ## search the order of the image's functions with the fewest long calls
function-order: $(FIRMWARE_ELF) $(FIRMWARE_BUILD)/screed.lst $(B)/avr_order
	@{ echo "# Sections of the image's functions in the order in which they lie. Made by: make function-order" ; \
	   $(B)/avr_order $(FIRMWARE_BUILD)/screed.map $(FIRMWARE_BUILD)/screed.lst ; } > $(FUNCTION_ORDER).new
	@mv $(FUNCTION_ORDER).new $(FUNCTION_ORDER)
$(B)/avr_order: $(B)/tools/avr/order/main.o $(B)/libavr_tools.a $(LIBRARY) $(B)/link.flags
	$(call link)

$(FIRMWARE_BUILD)/%.hex: $(FIRMWARE_BUILD)/%.elf
	@$(AVR_OBJCOPY) -O ihex -R .eeprom -R .fuse -R .lock $< $@

$(FIRMWARE_BUILD)/%.lst: $(FIRMWARE_BUILD)/%.elf
	@$(AVR_OBJDUMP) -d $< > $@

$(FIRMWARE_BUILD)/%.size: $(FIRMWARE_BUILD)/%.elf
	@$(AVR_SIZE) -A $< > $@

# The tests run the images of all boards.
OTHER_IMAGES := $(patsubst %,$(BUILD_ROOT)/firmware/%/screed.elf,$(filter-out $(BOARD),$(BOARDS)))
TEST_IMAGES += $(OTHER_IMAGES)
$(OTHER_IMAGES): $(BUILD_ROOT)/firmware/%/screed.elf: FORCE
	+@$(MAKE) --no-print-directory BUILD=$(BUILD) BUILD_ROOT=$(BUILD_ROOT) BOARD=$* $@
# And that of another node.
ifndef NODE
OTHER_NODE_IMAGE := $(FIRMWARE_BUILD)_node_3/screed.elf
TEST_IMAGES += $(OTHER_NODE_IMAGE)
$(OTHER_NODE_IMAGE): FORCE
	+@$(MAKE) --no-print-directory BUILD=$(BUILD) BUILD_ROOT=$(BUILD_ROOT) NODE=3 $@
endif
