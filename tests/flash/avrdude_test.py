"""What avrdude does with the board, and what becomes of what it says. SCREED_FLASH_IMAGE names the robot's image."""
import os
import subprocess
import unittest
from unittest import mock

from caterina_stand_in import BOOT_SECTION, FLASH_SIZE
from fake_usb import SketchPort
from flash_case import BOOTLOADER, PROGRAM, SKETCH, FlashCase, flash


class WritingAnImage(FlashCase):
    def test_the_robots_image_is_written_and_nothing_else(self):
        image = os.environ["SCREED_FLASH_IMAGE"]
        expected = self.bytes_of(image)
        self.assertGreater(len(expected), 1000)
        board = self.bootloader()
        self.assertEqual(self.write(image, "--port", board.port),
                         (0, f"writing {image} through {board.port}\n{len(expected)} bytes written and verified; "
                             "the board starts them now\n", ""))
        board.stop()
        self.assertEqual(board.flash[:BOOT_SECTION], expected.ljust(BOOT_SECTION, b"\xFF"))
        self.assertEqual(board.flash[BOOT_SECTION:], b"\x5A" * (FLASH_SIZE - BOOT_SECTION))
        self.assertEqual(board.complaint, "")
        self.assertLess(board.commands.index("e"), board.commands.index("B"))  # erased before written
        self.assertEqual(board.commands[-1], "E")  # and the sketch started

    def test_a_running_sketch_is_replaced(self):
        image = self.image_of(1000)
        board = self.bootloader()
        sketch = self.enterContext(SketchPort())
        self.usb.plug_in("1-1", SKETCH, "ttyACM0", sketch.name)

        def restart():
            self.assertTrue(sketch.touched())
            self.usb.unplug("1-1", "ttyACM0")
            self.usb.plug_in("1-1", BOOTLOADER, "ttyACM1", board.port)
        self.at_ms = {1200: restart}
        code, _, said = self.write(image)
        self.assertEqual(code, 0, said)
        self.assertEqual(board.flash[:1000], self.bytes_of(image))

    def test_a_byte_that_cannot_be_written_is_named(self):
        board = self.bootloader(worn_address=0x123)
        self.assertEqual(self.failure(self.write(self.image_of(1000), "--port", board.port), 1),
                         "verification failed at address 0x0123: the board has 0xff, the image 0xf7; do not let this "
                         "image drive, flash again")

    def test_an_image_that_reaches_into_the_bootloader_does_not_harm_it(self):
        board = self.bootloader()
        self.assertIn("verification failed at address 0x7000",
                      self.failure(self.write(self.image_of(BOOT_SECTION + 100), "--port", board.port), 1))
        self.assertEqual(board.flash[BOOT_SECTION:], b"\x5A" * (FLASH_SIZE - BOOT_SECTION))

    def test_a_wrong_chip_is_left_as_it_is(self):
        board = self.bootloader(signature=b"\x1E\x94\x88")  # ATmega16U4
        self.assertEqual(self.failure(self.write(self.image_of(1000), "--port", board.port), 1), "wrong chip: its "
                         "signature is 1E 94 88, that of an ATmega32U4 is 1E 95 87; nothing was written")
        self.assertEqual(board.flash, b"\x5A" * FLASH_SIZE)

    def test_a_board_that_dies_or_is_unplugged_half_way(self):
        for unplugged in (False, True):
            board = self.bootloader(dies_after=3, unplugged=unplugged)
            kill = subprocess.Popen.kill
            with mock.patch.object(subprocess.Popen, "kill", autospec=True, side_effect=kill) as killed:
                result = self.write(self.image_of(1000), "--port", board.port)
            killed.assert_called_once()
            self.assertEqual(self.failure(result, 1), f"no answer from {board.port} half-way: the image on the board "
                             "is incomplete; reset it twice and flash again")

    def test_a_port_without_a_bootloader(self):
        board = self.bootloader(dies_after=0)
        self.assertEqual(self.failure(self.write(self.image_of(1000), "--port", board.port), 1),
                         f"no answer from {board.port} to avrdude's first questions: is it a bootloader, and still "
                         "running (8 s)?")

    def test_without_an_image_it_says_so(self):
        self.assertEqual(self.failure(self.write("no_such.hex"), 2), "no image no_such.hex: make firmware builds it")


class WhatAvrdudeSays(FlashCase):
    """The transcripts are avrdude 7.1's own."""

    def call(self, *words):
        return self.write(self.image_of(10), "--port", "/dev/null", *words)

    def line_for(self, script):
        return self.failure(self.call(*self.avrdude(script)), 1)

    def test_why_it_cannot_open_the_port(self):
        for reason, line in (("Permission denied", "no right to open /dev/ttyACM0: install the udev rule"),
                             ("Device or resource busy", "/dev/ttyACM0 is in use: end the serial monitor")):
            self.assertIn(line, self.line_for(
                f"""echo 'avrdude OS error: cannot open port /dev/ttyACM0: {reason}'
                echo 'avrdude error: unable to open programmer avr109 on port /dev/ttyACM0' >&2; exit 1"""))

    def test_anything_else_is_its_first_error(self):
        program = self.folder / "avrdude"
        for script, line in (
                ("""echo 'avrdude error: no valid record found in Intel Hex file bad.hex'
                echo 'avrdude error: read from file bad.hex failed'; exit 1""",
                 f"{program} failed: no valid record found in Intel Hex file bad.hex"),
                ("echo 'avrdude done.  Thank you.'; exit 3", f"{program} failed: exit code 3"),
                ("echo 'avrdude done.  Thank you.'", f"{program} did not say that it verified the image")):
            self.assertEqual(self.line_for(script), line)

    def test_it_is_ended_when_the_first_answer_is_missing(self):
        """avrdude 7.1 goes on for minutes after the bootloader has stopped answering, one line every 5 s."""
        self.assertIn("half-way", self.line_for(
            "echo 'avrdude: erasing chip'; yes 'avrdude error: programmer is not responding' | head -n 10000"))

    def test_a_programmer_without_a_port_has_a_name(self):
        self.assertIn("no answer from usbasp to", self.failure(self.screed_flash(
            "fuses", "--mcu", "atmega32u4", "--programmer", "usbasp",
            *self.avrdude("echo 'avrdude error: programmer is not responding'; exit 1")), 1))

    def test_verbose_shows_all_of_it(self):
        code, _, said = self.call("--verbose", *self.avrdude('echo "$@" >&2; echo 10 bytes of flash verified'))
        self.assertEqual((code, said), (0, "-p atmega32u4 -c avr109 -P /dev/null -b 57600 -e -U "
                                           f"flash:w:{self.folder}/image.hex:i\n10 bytes of flash verified\n"))

    def test_one_that_is_not_installed(self):
        self.assertEqual(self.failure(self.call("--avrdude", "no_avrdude"), 1),
                         "no_avrdude is not installed: make deps, or apt install no_avrdude")
        self.assertEqual(self.failure(self.call("--avrdude", "/dev"), 1), "cannot run /dev: Permission denied")


class Fuses(FlashCase):
    def fuses(self, *words):
        return self.screed_flash("fuses", "--mcu", "atmega32u4", *words)

    def recorder(self):
        """An avrdude that only writes down how it was called, and reads the right fuses: bits that do not exist may
        read otherwise."""
        self.calls = self.folder / "calls"
        return self.avrdude(f"echo \"$@\" >> {self.calls}; printf '0xff\\n0xd0\\n0xf8\\n0x2f\\n'\n")

    def test_the_bootloader_reads_them(self):
        board = self.bootloader()
        self.assertEqual(self.fuses("--programmer", "avr109", "--port", board.port), (
            0, "low fuse: should be 0xFF, is 0xFF\nhigh fuse: should be 0xD0, is 0xD0\n"
            "extended fuse: should be 0xC8, is 0xF8\nlock fuse: should be 0xEF, is 0xEF\n"
            "the fuses are right (bits that do not exist read as 1)\n", ""))

    def test_those_that_differ_are_named(self):
        board = self.bootloader(fuses=b"\xFF\xD8\xFB\xEF")  # EEPROM lost at an erase, brown-out at 2.6 V
        self.assertEqual(self.failure(self.fuses("--programmer", "avr109", "--port", board.port), 1),
                         "the board's fuses differ from what they should be: high, extended")

    def test_the_bootloader_cannot_write_them(self):
        board = self.bootloader()
        self.assertEqual(self.failure(self.fuses("--programmer", "avr109", "--port", board.port, "--write"), 2),
                         "PROGRAMMER=avr109, the bootloader, can read fuses but not write them: that takes an ISP "
                         "programmer")
        board.stop()
        self.assertEqual(board.commands, "")

    def test_without_a_programmer_they_are_only_printed(self):
        code, said, _ = self.fuses(*self.recorder())
        self.assertEqual(code, 0)
        self.assertEqual(said.splitlines()[:7], [
            "low       0xFF  crystal",
            "high      0xD0  reset starts the bootloader at 0x7000, EEPROM survives an erase, JTAG off (PF4 to PF7 are "
            "pins)",
            "extended  0xC8  brown-out reset 4.3 V",
            "lock      0xEF  sketches cannot overwrite the bootloader",
            "",
            "to write them with an ISP programmer:",
            f"  {self.folder}/avrdude -p atmega32u4 -c PROGRAMMER -U lfuse:w:0xFF:m -U hfuse:w:0xD0:m "
            "-U efuse:w:0xC8:m -U lock:w:0xEF:m"])
        self.assertFalse(self.calls.exists())
        self.assertIn("WRITE=yes needs PROGRAMMER=...", self.failure(self.fuses("--write"), 2))

    def test_other_values_are_explained_as_well(self):
        said = self.fuses("--low", "0X62", "--high", "9c", "--extended", "0xFE", "--lock", "0xff")[1]
        self.assertEqual(said.splitlines()[:4], [
            "low       0x62  internal RC oscillator, divided by 8",
            "high      0x9C  reset starts the bootloader at 0x7C00, an erase clears the EEPROM, JTAG on",
            "extended  0xFE  brown-out reset 2.0 V",
            "lock      0xFF  sketches can overwrite the bootloader"])
        self.assertIn("reset starts the sketch,", self.fuses("--high", "0xD1")[1])

    def test_what_is_no_byte_is_refused(self):
        for wrong in ("", "0x", "0x100", "-1", "D0 ", "high"):
            self.assertEqual(self.failure(self.fuses(f"--low={wrong}"), 2), f"argument --low: '{wrong}': "
                             "a byte in hexadecimal, as 0xD0 (see screed_flash fuses --help)")

    def test_an_isp_programmer_reads_unless_told_to_write(self):
        programmer = ("--programmer", "usbasp", *self.recorder())
        read = "-p atmega32u4 -c usbasp -qq -U lfuse:r:-:h -U hfuse:r:-:h -U efuse:r:-:h -U lock:r:-:h\n"
        self.assertEqual(self.fuses(*programmer)[0], 0)
        self.assertEqual(self.calls.read_text(), read)
        self.calls.unlink()
        self.assertEqual(self.fuses(*programmer, "--write")[0], 0)
        # Written with the lock byte last, then read back.
        self.assertEqual(self.calls.read_text(), "-p atmega32u4 -c usbasp -U lfuse:w:0xFF:m -U hfuse:w:0xD0:m "
                         "-U efuse:w:0xC8:m -U lock:w:0xEF:m\n" + read)

    def test_an_avrdude_that_reports_none(self):
        self.assertEqual(self.failure(self.fuses("--programmer", "usbasp", *self.avrdude("echo 0xff")), 1),
                         f"{self.folder}/avrdude did not report the fuses")


class TheProgram(FlashCase):
    def test_output_and_exit_code_as_others_see_them(self):
        fuses = ("fuses", "--mcu", "atmega32u4", "--programmer", "usbasp",
                 *self.avrdude("printf '0xff\\n0xd0\\n0xf8\\n0xef\\n'"))
        for words, code, end in (
                (fuses, 0, "lock fuse: should be 0xEF, is 0xEF\n"
                           "the fuses are right (bits that do not exist read as 1)\n"),
                ((*fuses, "--lock", "0xFF"), 1, "lock fuse: should be 0xFF, is 0xEF\n"
                 "screed_flash: the board's fuses differ from what they should be: lock\n"),
                (["write"], 2, "screed_flash: the following arguments are required: --mcu, image "
                               "(see screed_flash write --help)\n")):
            result = subprocess.run([PROGRAM, *words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            self.assertEqual(result.returncode, code)
            self.assertEqual(result.stdout[-len(end):], end)


class Waiting(unittest.TestCase):
    def test_for_output(self):
        output, child = os.pipe()
        self.assertFalse(flash.output_within(output, 0))
        os.close(child)  # the end counts as well
        self.assertTrue(flash.output_within(output, 0))
        os.close(output)
