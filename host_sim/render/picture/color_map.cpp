// Ramps are laid through anchor colours in OKLab, where equal distances look equal
// (B. Ottosson, "A perceptual color space for image processing", 2020).
#include "host_sim/render/picture/color_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace screed {

namespace {

/// OKLab: lightness 0..1, a = green to red, b = blue to yellow.
struct Lab {
  double lightness;
  double a;
  double b;
};

double encode_srgb(double linear) {
  const double c = std::clamp(linear, 0.0, 1.0);
  return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1.0 / 2.4) - 0.055;
}

Color to_color(const Lab& lab) {
  const double l = std::pow(lab.lightness + 0.3963377774 * lab.a + 0.2158037573 * lab.b, 3.0);
  const double m = std::pow(lab.lightness - 0.1055613458 * lab.a - 0.0638541728 * lab.b, 3.0);
  const double s = std::pow(lab.lightness - 0.0894841775 * lab.a - 1.2914855480 * lab.b, 3.0);
  return {encode_srgb(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
          encode_srgb(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
          encode_srgb(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s)};
}

/// Anchors are evenly spaced over t = 0..1.
Color along(std::span<const Lab> anchors, double t) {
  const double place = std::clamp(t, 0.0, 1.0) * static_cast<double>(anchors.size() - 1);
  const size_t low = std::min(static_cast<size_t>(place), anchors.size() - 2);
  const double part = place - static_cast<double>(low);
  const auto mix = [part](double from, double to) { return from + part * (to - from); };
  const Lab& from = anchors[low];
  const Lab& to = anchors[low + 1];
  return to_color({mix(from.lightness, to.lightness), mix(from.a, to.a), mix(from.b, to.b)});
}

constexpr std::array<Lab, 6> kHeightAnchors = {{
    {0.42, -0.020, -0.050},  // slate blue
    {0.52, -0.048, -0.012},  // teal
    {0.62, -0.050, 0.040},   // moss
    {0.72, -0.012, 0.075},   // olive sand
    {0.82, 0.018, 0.068},    // sand
    {0.94, 0.006, 0.022},    // pale dune
}};

constexpr std::array<Lab, 6> kSlopeAnchors = {{
    {0.93, -0.018, 0.008},  // pale mint
    {0.87, -0.020, 0.070},  // straw
    {0.77, 0.045, 0.110},   // amber
    {0.63, 0.125, 0.085},   // vermilion
    {0.46, 0.135, 0.025},   // crimson
    {0.30, 0.075, -0.015},  // dark wine
}};

constexpr std::array<Lab, 5> kDifferenceAnchors = {{
    {0.42, -0.030, -0.120},
    {0.69, -0.030, -0.080},
    {0.965, 0.000, 0.003},
    {0.69, 0.080, 0.070},
    {0.42, 0.110, 0.065},
}};

constexpr std::array<Color, kCategoryColors> kCategories = {{
    {0.835, 0.369, 0.000},  // vermilion
    {0.000, 0.447, 0.698},  // blue
    {0.960, 0.830, 0.160},  // yellow
    {0.800, 0.475, 0.655},  // purple
    {0.337, 0.706, 0.914},  // sky
    {0.000, 0.620, 0.451},  // green
    {0.902, 0.624, 0.000},  // orange
    {0.250, 0.250, 0.250},  // charcoal
    {0.560, 0.050, 0.200},  // wine
    {0.600, 0.800, 0.250},  // lime
}};

uint32_t byte_of(double component) {
  return static_cast<uint32_t>(std::lround(std::clamp(component, 0.0, 1.0) * 255.0));
}

}  // namespace

uint32_t pixel_of(Color color) {
  return (byte_of(color.red) << 16) | (byte_of(color.green) << 8) | byte_of(color.blue);
}

std::vector<uint8_t> rgb_bytes(std::span<const uint32_t> pixels) {
  std::vector<uint8_t> bytes(3 * pixels.size());
  uint8_t* byte = bytes.data();
  for (const uint32_t pixel : pixels) {
    *byte++ = static_cast<uint8_t>(pixel >> 16);
    *byte++ = static_cast<uint8_t>(pixel >> 8);
    *byte++ = static_cast<uint8_t>(pixel);
  }
  return bytes;
}

Color height_color(double t) {
  return along(kHeightAnchors, t);
}

Color slope_color(double t) {
  return along(kSlopeAnchors, t);
}

Color difference_color(double t) {
  return along(kDifferenceAnchors, 0.5 * (t + 1.0));
}

Color category_color(size_t index) {
  return kCategories[index % kCategories.size()];
}

Color line_color(size_t index) {
  constexpr std::array<size_t, 8> kOnWhite = {0, 1, 5, 3, 7, 6, 4, 8};
  return kCategories[kOnWhite[index % kOnWhite.size()]];
}

Color ink_on(Color ground) {
  // Weights of ITU-R BT.601 for gamma-encoded components.
  const double luma = 0.299 * ground.red + 0.587 * ground.green + 0.114 * ground.blue;
  return luma > 0.55 ? Color{0.1, 0.1, 0.1} : Color{1.0, 1.0, 1.0};
}

}  // namespace screed
