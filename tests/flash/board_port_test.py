"""Finding the board and its bootloader."""
import errno
import os
from unittest import mock

from fake_usb import SketchPort
from flash_case import BOOTLOADER, SKETCH, FlashCase

OTHER = "0403:6001"
RESET_TWICE = "press its reset button twice within 750 ms (its yellow LED then fades in and out for 8 s) and try again"


class FindingTheBoard(FlashCase):
    def port(self, *words):
        return self.screed_flash("port", *words)

    def test_the_only_board_is_taken_sketch_or_bootloader(self):
        self.usb.plug_in("1-2", OTHER, "ttyUSB0")
        for usb_id in (SKETCH, BOOTLOADER):
            self.usb.plug_in("1-1", usb_id, "ttyACM4")
            self.assertEqual(self.port(), (0, f"{self.usb.dev}/ttyACM4\n", ""))
            self.usb.unplug("1-1", "ttyACM4")

    def test_without_a_board_it_says_what_it_looked_for_and_lists_the_ports_in_order(self):
        self.usb.plug_in("1-2", OTHER, "ttyUSB0", product="FT232R")
        self.usb.plug_in("1-1.4", OTHER, "ttyACM3")
        self.assertEqual(
            self.failure(self.port(), 1),
            "no board found: looked for USB 1ffb:2300 and, in its bootloader, 1ffb:0101 among the serial ports on USB: "
            f"{self.usb.dev}/ttyACM3 (USB 0403:6001), {self.usb.dev}/ttyUSB0 (USB 0403:6001, FT232R); "
            f"if it is plugged in, {RESET_TWICE}")

    def test_one_that_is_just_unplugged_is_not_listed(self):
        self.usb.plug_in("1-1", OTHER, "ttyACM0")
        self.usb.plug_in("1-2", OTHER, "ttyACM1")
        (self.usb.sockets / "1-1/idVendor").write_text("")
        (self.usb.sockets / "1-2/idProduct").unlink()
        self.assertIn("on USB: none;", self.failure(self.port(), 1))

    def test_a_machine_may_have_no_serial_port_at_all(self):
        self.assertIn("on USB: none;", self.failure(self.port("--sys", "/no_such"), 1))

    def test_several_boards_are_listed(self):
        self.usb.plug_in("1-1", SKETCH, "ttyACM0")
        self.usb.plug_in("1-2", BOOTLOADER, "ttyACM1")
        self.usb.plug_in("1-3", OTHER, "ttyUSB0")
        self.assertEqual(self.failure(self.port(), 1), "several boards found, choose one with PORT=...: "
                         f"{self.usb.dev}/ttyACM0 (USB 1ffb:2300), {self.usb.dev}/ttyACM1 (USB 1ffb:0101)")

    def test_the_one_asked_for_is_taken_under_any_name(self):
        for number, file in enumerate(("/dev/null", "/dev/zero")):
            self.usb.plug_in(f"1-{number}", SKETCH, f"ttyACM{number}", file)
        link = self.folder / "by-id"
        link.symlink_to(self.usb.dev / "ttyACM1")
        self.assertEqual(self.port("--port", link), (0, f"{self.usb.dev}/ttyACM1\n", ""))

    def test_another_device_is_refused(self):
        self.usb.plug_in("1-2", OTHER, "ttyUSB0", "/dev/null")
        radio = self.usb.dev / "ttyUSB0"
        self.assertEqual(self.failure(self.port("--port", radio), 2),
                         f"PORT={radio} is {radio} (USB 0403:6001), not the board, which is USB 1ffb:2300 or, "
                         "in its bootloader, 1ffb:0101")

    def test_a_port_that_does_not_exist_is_named(self):
        self.assertEqual(self.failure(self.port("--port", "/dev/no_such"), 2),
                         "PORT=/dev/no_such does not exist; serial ports on USB: none")

    def test_other_boards_have_other_ids(self):
        self.usb.plug_in("1-1", "2341:80af", "ttyACM0")
        for option in ("--sketch-usb", "--bootloader-usb"):
            self.assertEqual(self.port(option, "2341:80AF"), (0, f"{self.usb.dev}/ttyACM0\n", ""))

    def test_what_is_no_usb_id_is_refused(self):
        for wrong in ("", "1ffb", "1ffb:230", "1ffb:23000", "0x1ffb:2300", "1ffb-2300"):
            self.assertEqual(self.failure(self.port("--sketch-usb", wrong), 2),
                             f"argument --sketch-usb: '{wrong}': two numbers of four hexadecimal digits, as 1ffb:2300 "
                             "(see screed_flash port --help)")


class StartingTheBootloader(FlashCase):
    def setUp(self):
        super().setUp()
        self.sketch = self.enterContext(SketchPort())

    def come(self, usb_id, tty):
        self.usb.plug_in("1-1", usb_id, tty, self.sketch.name if usb_id == SKETCH else "/dev/null")

    def go(self, tty):
        self.assertTrue(self.sketch.touched())
        self.usb.unplug("1-1", tty)

    def start(self, *words):
        """Lines of progress up to the call of an avrdude that does nothing."""
        code, said, error = self.write(self.image_of(10), *self.avrdude("echo 10 bytes of flash verified"), *words)
        self.assertEqual(code, 0, error)
        return said.replace(f"{self.usb.dev}/", "").replace(f"{self.folder}/", "").splitlines()[:-1]

    def test_it_comes_back_under_another_name(self):
        self.come(SKETCH, "ttyACM0")
        self.usb.plug_in("1-2", BOOTLOADER, "ttyACM1", "/dev/zero")  # another robot
        self.at_ms = {200: lambda: self.go("ttyACM0"), 1500: lambda: self.come(BOOTLOADER, "ttyACM2")}
        self.assertEqual(self.start("--port", self.usb.dev / "ttyACM0"),
                         ["restarting ttyACM0 in its bootloader", "writing image.hex through ttyACM2"])
        self.assertEqual(self.now_ms, 1500)

    def test_it_comes_back_under_the_same_name(self):
        self.come(SKETCH, "ttyACM0")
        self.at_ms = {800: lambda: [self.go("ttyACM0"), self.come(BOOTLOADER, "ttyACM0")]}
        self.assertEqual(self.start(), ["restarting ttyACM0 in its bootloader", "writing image.hex through ttyACM0"])

    def test_a_sketch_that_only_restarts_is_touched_again_under_its_new_name(self):
        self.come(SKETCH, "ttyACM0")
        self.at_ms = {1000: lambda: [self.go("ttyACM0"), self.come(SKETCH, "ttyACM5")],
                      6000: lambda: [self.go("ttyACM5"), self.come(BOOTLOADER, "ttyACM6")]}
        self.assertEqual(self.start(), ["restarting ttyACM0 in its bootloader", "restarting ttyACM5 in its bootloader",
                                        "writing image.hex through ttyACM6"])

    def test_one_that_never_comes_ends_after_three_touches(self):
        self.come(SKETCH, "ttyACM0")
        result = self.write(self.image_of(10))
        port = self.usb.dev / "ttyACM0"
        self.assertEqual(self.failure(result, 1), f"no bootloader: {port} was opened at 1200 baud 3 times, but no USB "
                         f"1ffb:0101 came up in its place; {RESET_TWICE}")
        self.assertEqual(result[1], f"restarting {port} in its bootloader\n" * 3)
        self.assertEqual(self.now_ms, 15000)

    def test_one_that_runs_already_is_left_alone(self):
        self.usb.plug_in("1-1", BOOTLOADER, "ttyACM0", self.sketch.name)
        self.assertEqual(self.start(), ["writing image.hex through ttyACM0"])
        self.assertFalse(self.sketch.touched())
        self.assertEqual(self.now_ms, 0)

    def test_a_sketch_that_vanishes_before_the_touch_is_no_error(self):
        self.usb.plug_in("1-1", SKETCH, "ttyACM0")  # without a file
        self.at_ms = {50: lambda: [self.usb.unplug("1-1", "ttyACM0"), self.come(BOOTLOADER, "ttyACM0")]}
        self.assertEqual(self.start()[-1], "writing image.hex through ttyACM0")

    def test_a_sketch_that_may_not_be_opened_says_why(self):
        self.come(SKETCH, "ttyACM0")
        port = self.usb.dev / "ttyACM0"
        for error, line in ((errno.EACCES, f"no right to open {port}: install the udev rule"),
                            (errno.EBUSY, f"{port} is in use: end the serial monitor"),
                            (errno.EINVAL, f"cannot open {port}: Invalid argument")):
            image = self.image_of(10)
            with mock.patch.object(os, "open", side_effect=OSError(error, os.strerror(error))):
                self.assertIn(line, self.failure(self.write(image), 1))

    def test_a_bootloader_gets_its_rights_a_moment_later(self):
        self.come(SKETCH, "ttyACM0")
        self.at_ms = {100: lambda: [self.go("ttyACM0"), self.come(BOOTLOADER, "ttyACM1")]}
        with mock.patch.object(os, "access", lambda file, _: str(file).endswith("ttyACM1") and self.now_ms >= 300):
            self.assertEqual(self.start()[-1], "writing image.hex through ttyACM1")
        self.assertEqual(self.now_ms, 300)

    def test_a_bootloader_that_never_gets_them_is_named(self):
        self.come(SKETCH, "ttyACM0")
        self.at_ms = {100: lambda: [self.go("ttyACM0"), self.come(BOOTLOADER, "ttyACM1")]}
        with mock.patch.object(os, "access", return_value=False):
            self.assertIn(f"no right to open {self.usb.dev}/ttyACM1: install the udev rule",
                          self.failure(self.write(self.image_of(10)), 1))
