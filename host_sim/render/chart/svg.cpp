// SVG text, and PNG files of it by librsvg and cairo.
#include "host_sim/render/chart/svg.h"

#include <cairo.h>
#include <librsvg/rsvg.h>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <memory>
#include <span>
#include <string_view>
#include <thread>
#include <vector>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/base64.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/memory_room.h"
#include "host_sim/physics/terrain/grey_image.h"
#include "host_sim/render/picture/color_map.h"

namespace screed {

namespace {

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.2f", value);
  std::string_view view(text);
  while (view.back() == '0') view.remove_suffix(1);
  if (view.back() == '.') view.remove_suffix(1);
  return view == "-0" ? "0" : std::string(view);
}

std::string escaped(const std::string& words) {
  std::string out;
  for (const char c : words) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string hex(Color color) {
  char text[8];
  std::snprintf(text, sizeof text, "#%06x", pixel_of(color));
  return text;
}

/// ` name="value"`.
std::string svg_attribute(const char* name, const std::string& value) {
  std::string text = " ";
  text += name;
  text += "=\"";
  text += value;
  text += '"';
  return text;
}

std::string svg_attribute(const char* name, double value) {
  return svg_attribute(name, number(value));
}

/// Where a box lies.
std::string placed(const PixelBox& box) {
  return svg_attribute("x", box.left) + svg_attribute("y", box.top) +
         svg_attribute("width", box.width) + svg_attribute("height", box.height);
}

std::string circle(Pixel at, double radius_px) {
  return "<circle" + svg_attribute("cx", at.x) + svg_attribute("cy", at.y) +
         svg_attribute("r", radius_px);
}

bool continues_letter(char c) {
  return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;
}

}  // namespace

double svg_text_width_px(const std::string& words, double size_px) {
  constexpr double kLetterWidth = 0.56;  // of the font's size
  const auto letters =
      std::count_if(words.begin(), words.end(), [](char c) { return !continues_letter(c); });
  return static_cast<double>(letters) * kLetterWidth * size_px;
}

std::string svg_fitted(const std::string& words, double size_px, double width_px) {
  if (svg_text_width_px(words, size_px) <= width_px) return words;
  std::string cut = words;
  while (!cut.empty()) {
    while (!cut.empty() && continues_letter(cut.back())) cut.pop_back();
    if (!cut.empty()) cut.pop_back();
    if (!cut.empty() && svg_text_width_px(cut + "\u2026", size_px) <= width_px) {
      return cut + "\u2026";
    }
  }
  return cut;
}

Svg::Svg(int width_px, int height_px) {
  out_ = "<svg xmlns=\"http://www.w3.org/2000/svg\"" + svg_attribute("width", width_px) +
         svg_attribute("height", height_px) +
         svg_attribute("viewBox", "0 0 " + number(width_px) + " " + number(height_px)) +
         svg_attribute("font-family", "'DejaVu Sans', Verdana, Arial, sans-serif") +
         ">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
}

void Svg::line(Pixel from, Pixel to, Color color, double width_px) {
  out_ += "<line" + svg_attribute("x1", from.x) + svg_attribute("y1", from.y) +
          svg_attribute("x2", to.x) + svg_attribute("y2", to.y) +
          svg_attribute("stroke", hex(color)) + svg_attribute("stroke-width", width_px) + "/>\n";
}

void Svg::polyline(const std::vector<Pixel>& points, Color color, double width_px, bool dashed) {
  out_ += "<polyline fill=\"none\"" + svg_attribute("stroke", hex(color)) +
          svg_attribute("stroke-width", width_px) +
          " stroke-linejoin=\"round\" stroke-linecap=\"round\"";
  if (dashed) out_ += svg_attribute("stroke-dasharray", "7 6");
  out_ += " points=\"";
  for (const Pixel& point : points) {
    out_ += number(point.x);
    out_ += ',';
    out_ += number(point.y);
    out_ += ' ';
  }
  out_.back() = '"';
  out_ += "/>\n";
}

void Svg::marker(Pixel at, double radius_px, Color color) {
  out_ += circle(at, radius_px) + svg_attribute("fill", hex(color)) +
          " stroke=\"#ffffff\" stroke-width=\"1.2\"/>\n";
}

void Svg::small_dot(Pixel at, Color color) {
  out_ += circle(at, 1.6) + svg_attribute("fill", hex(color)) + " fill-opacity=\"0.45\"/>\n";
}

void Svg::ring(Pixel at, double radius_px, Color color) {
  out_ += circle(at, radius_px) + " fill=\"#ffffff\"" + svg_attribute("stroke", hex(color)) +
          " stroke-width=\"2.4\"/>\n";
}

void Svg::rectangle(const PixelBox& box, Color fill, double round_px) {
  out_ += "<rect" + placed(box) + svg_attribute("fill", hex(fill));
  if (round_px > 0.0) out_ += svg_attribute("rx", round_px);
  out_ += "/>\n";
}

void Svg::frame(const PixelBox& box, Color color, double width_px) {
  out_ += "<rect" + placed(box) + " fill=\"none\"" + svg_attribute("stroke", hex(color)) +
          svg_attribute("stroke-width", width_px) + "/>\n";
}

void Svg::text(Pixel at, const std::string& words, const SvgTextStyle& style) {
  if (words.empty()) return;
  constexpr const char* kAnchors[] = {"start", "middle", "end"};
  out_ += "<text" + svg_attribute("x", at.x) + svg_attribute("y", at.y) +
          svg_attribute("font-size", style.size_px) + svg_attribute("fill", hex(style.color)) +
          svg_attribute("text-anchor", kAnchors[static_cast<int>(style.anchor)]);
  if (style.bold) out_ += svg_attribute("font-weight", "bold");
  if (style.upwards) {
    out_ += svg_attribute("transform", "rotate(-90 " + number(at.x) + " " + number(at.y) + ")");
  }
  out_ += ">" + escaped(words) + "</text>\n";
}

void Svg::image(const PixelBox& box, std::span<const std::uint8_t> png) {
  out_ += "<image" + placed(box) + " preserveAspectRatio=\"none\" href=\"data:image/png;base64," +
          base64(png) + "\"/>\n";
}

void Svg::begin_clip(const PixelBox& box) {
  const std::string id = "clip" + std::to_string(++clips_);
  out_ += "<clipPath" + svg_attribute("id", id) + "><rect" + placed(box) + "/></clipPath>\n<g" +
          svg_attribute("clip-path", "url(#" + id + ")") + ">\n";
}

void Svg::end_clip() {
  out_ += "</g>\n";
}

std::string Svg::finish() {
  out_ += "</svg>\n";
  return std::move(out_);
}

namespace {

struct Release {
  void operator()(RsvgHandle* it) const { g_object_unref(it); }
  void operator()(cairo_surface_t* it) const { cairo_surface_destroy(it); }
  void operator()(cairo_t* it) const { cairo_destroy(it); }
};

[[noreturn]] void fail(const std::filesystem::path& path, GError* error) {
  std::string what = path.string() + ": the picture cannot be drawn";
  if (error != nullptr) what += std::string(": ") + error->message;
  g_clear_error(&error);
  throw RunError(what);
}

/// Pango's threads and GLib's memory end the program where there is no room for them.
void check_room(const std::filesystem::path& path) {
  constexpr std::size_t kRoom = 192U << 20U;  // of addresses: an arena for each thread
  try {
    check_memory(kRoom);
    std::thread([] {}).join();
  } catch (const std::exception&) {
    throw RunError(path.string() + ": the picture cannot be drawn: out of memory");
  }
}

}  // namespace

void write_svg_as_png(const std::filesystem::path& path, const std::string& svg, double scale) {
  check_room(path);
  GError* error = nullptr;
  const std::unique_ptr<RsvgHandle, Release> picture(
      rsvg_handle_new_from_data(reinterpret_cast<const guint8*>(svg.data()), svg.size(), &error));
  if (picture == nullptr) fail(path, error);
  double width = 0.0;
  double height = 0.0;
  if (rsvg_handle_get_intrinsic_size_in_pixels(picture.get(), &width, &height) == 0) {
    throw RunError(path.string() + ": the picture has no size in pixels");
  }
  const RsvgRectangle all = {0.0, 0.0, std::ceil(width * scale), std::ceil(height * scale)};
  const std::unique_ptr<cairo_surface_t, Release> surface(cairo_image_surface_create(
      CAIRO_FORMAT_RGB24, static_cast<int>(all.width), static_cast<int>(all.height)));
  const std::unique_ptr<cairo_t, Release> cairo(cairo_create(surface.get()));
  cairo_set_source_rgb(cairo.get(), 1.0, 1.0, 1.0);
  cairo_paint(cairo.get());
  if (rsvg_handle_render_document(picture.get(), cairo.get(), &all, &error) == 0) {
    fail(path, error);
  }
  const cairo_status_t status = cairo_status(cairo.get());
  if (status != CAIRO_STATUS_SUCCESS) {
    throw RunError(path.string() +
                   ": the picture cannot be drawn: " + cairo_status_to_string(status));
  }
  cairo_surface_flush(surface.get());
  // Rows of 32-bit pixels are never padded.
  const std::span pixels(
      reinterpret_cast<const std::uint32_t*>(cairo_image_surface_get_data(surface.get())),
      static_cast<std::size_t>(all.width) * static_cast<std::size_t>(all.height));
  write_rgb_png(path, static_cast<int>(all.width), static_cast<int>(all.height), rgb_bytes(pixels));
}

void check_picture_name(const std::string& option, const std::filesystem::path& path) {
  if (path.extension() == ".svg" || path.extension() == ".png") return;
  throw InputError(option + " " + path.string() + ": the name ends in .svg or .png");
}

void write_picture(const std::filesystem::path& path, const std::string& svg) {
  if (path.extension() == ".png") {
    write_svg_as_png(path, svg);
  } else {
    write_file(path, svg);
  }
}

}  // namespace screed
