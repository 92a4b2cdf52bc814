#include "engine/image/flip.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/error.h"
#include "engine/image/compare.h"

namespace radivox::image {

namespace {

using Triple = std::array<double, 3>;
/// One value a pixel, double: filters of large kernels add many small terms.
using Plane = std::vector<double>;

constexpr double kPi = 3.14159265358979323846;

// The constants of the papers: exponent and knee of the colour difference, where the knee lands, width and exponent of features.
constexpr double kColorExponent = 0.7, kKnee = 0.4, kKneeValue = 0.95, kFeatureWidth = 0.082, kFeatureExponent = 0.5;

// ---- colour spaces ----

// Linear Rec. 709 to XYZ under D65, from its primaries, as exact fractions.
constexpr double kToXyz[3][3] = {{10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
                                 {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
                                 {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382}};

struct Inverse {
  double m[3][3];
  Inverse() {
    const auto& a = kToXyz;
    const auto minor = [&a](int r0, int r1, int c0, int c1) { return a[r0][c0] * a[r1][c1] - a[r0][c1] * a[r1][c0]; };
    const double determinant = a[0][0] * minor(1, 2, 1, 2) - a[0][1] * minor(1, 2, 0, 2) + a[0][2] * minor(1, 2, 0, 1);
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) m[c][r] = minor((r + 1) % 3, (r + 2) % 3, (c + 1) % 3, (c + 2) % 3) / determinant;
    }
  }
};

Triple multiply(const double (&m)[3][3], const Triple& v) {
  Triple result;
  for (size_t r = 0; r < 3; ++r) result[r] = m[r][0] * v[0] + m[r][1] * v[1] + m[r][2] * v[2];
  return result;
}

/// XYZ relative to the white of the screen, (1, 1, 1).
Triple toRelativeXyz(const Triple& rgb) {
  const Triple xyz = multiply(kToXyz, rgb), white = multiply(kToXyz, {1, 1, 1});
  return {xyz[0] / white[0], xyz[1] / white[1], xyz[2] / white[2]};
}

/// Linear opponent colours YyCxCz.
Triple toOpponent(const Triple& rgb) {
  const Triple xyz = toRelativeXyz(rgb);
  return {116 * xyz[1] - 16, 500 * (xyz[0] - xyz[1]), 200 * (xyz[1] - xyz[2])};
}

Triple fromOpponent(const Triple& yCxCz) {
  static const Inverse kInverse;
  const double y = (yCxCz[0] + 16) / 116;
  const Triple white = multiply(kToXyz, {1, 1, 1});
  return multiply(kInverse.m, {(y + yCxCz[1] / 500) * white[0], y * white[1], (y - yCxCz[2] / 200) * white[2]});
}

/// CIELAB with the Hunt effect: colours look more colourful in bright light.
Triple toHuntLab(const Triple& rgb) {
  constexpr double kDelta = 6.0 / 29;
  Triple f = toRelativeXyz(rgb);
  for (double& t : f) t = t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0 / 29;
  const double lightness = 116 * f[1] - 16;
  return {lightness, 0.01 * lightness * 500 * (f[0] - f[1]), 0.01 * lightness * 200 * (f[1] - f[2])};
}

/// HyAB distance to the power of the paper's exponent.
double colorDistance(const Triple& a, const Triple& b) {
  return std::pow(std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]), kColorExponent);
}

/// The distance that nothing on a screen exceeds by much: green against blue.
double largestDistance() { return colorDistance(toHuntLab({0, 1, 0}), toHuntLab({0, 0, 1})); }

// ---- separable filters ----

/// Taps from −radius to +radius.
using Kernel = std::vector<double>;

template <class F>
Kernel makeKernel(int radius, F value) {
  Kernel kernel;
  for (int i = -radius; i <= radius; ++i) kernel.push_back(value(static_cast<double>(i)));
  return kernel;
}

double sumOf(const Kernel& kernel) {
  double sum = 0;
  for (const double tap : kernel) sum += tap;
  return sum;
}

struct Size {
  int width, height;
};

/// Rows, then columns; what lies outside has the value of the nearest pixel of the edge.
Plane filter(const Plane& in, Size size, const Kernel& alongX, const Kernel& alongY) {
  const auto [width, height] = size;
  const int radiusX = static_cast<int>(alongX.size() / 2), radiusY = static_cast<int>(alongY.size() / 2);
  const auto rowOf = [width = width](int y) { return static_cast<size_t>(y) * static_cast<size_t>(width); };
  Plane middle(in.size()), out(in.size(), 0.0);
  std::vector<double> padded(static_cast<size_t>(width + 2 * radiusX));
  for (int y = 0; y < height; ++y) {
    const double* row = in.data() + rowOf(y);
    for (int x = -radiusX; x < width + radiusX; ++x) padded[static_cast<size_t>(x + radiusX)] = row[std::clamp(x, 0, width - 1)];
    double* to = middle.data() + rowOf(y);
    for (size_t k = 0; k < alongX.size(); ++k) {
      for (size_t x = 0; x < static_cast<size_t>(width); ++x) to[x] += alongX[k] * padded[x + k];
    }
  }
  for (int y = 0; y < height; ++y) {
    double* to = out.data() + rowOf(y);
    for (int k = -radiusY; k <= radiusY; ++k) {
      const double tap = alongY[static_cast<size_t>(k + radiusY)];
      const double* from = middle.data() + rowOf(std::clamp(y + k, 0, height - 1));
      for (int x = 0; x < width; ++x) to[x] += tap * from[x];
    }
  }
  return out;
}

// ---- colour pipeline ----

/// The eye's contrast sensitivity in one opponent channel: a sum of Gaussians over degrees.
struct Sensitivity {
  double a, b;
};
constexpr Sensitivity kAchromatic{1.0, 0.0047}, kRedGreen{1.0, 0.0053}, kBlueYellow[2] = {{34.1, 0.04}, {13.5, 0.025}};

struct Opponent {
  Plane channels[3];
};

/// What the eye resolves: each channel smoothed by its sensitivity.
Opponent resolve(const Opponent& in, Size size, double pixelsPerDegree) {
  // Three standard deviations of the widest Gaussian.
  const int radius = static_cast<int>(std::ceil(3 * std::sqrt(kBlueYellow[0].b / (2 * kPi * kPi)) * pixelsPerDegree));
  const auto gaussian = [&](double b) {
    return makeKernel(radius, [&](double i) { return std::exp(-kPi * kPi * i * i / (pixelsPerDegree * pixelsPerDegree * b)); });
  };
  const auto scaled = [](Kernel kernel, double factor) {
    for (double& tap : kernel) tap *= factor;
    return kernel;
  };
  Opponent out;
  for (const auto& [channel, b] : {std::pair<int, double>{0, kAchromatic.b}, {1, kRedGreen.b}}) {
    const Kernel kernel = gaussian(b);
    const Kernel unit = scaled(kernel, 1 / sumOf(kernel));
    out.channels[channel] = filter(in.channels[channel], size, unit, unit);
  }
  // A sum of two Gaussians of (x, y) is not separable, but each of them is. Each has the weight a·√(π/b), and their two-dimensional taps
  // together add up to 1.
  const Kernel wide = gaussian(kBlueYellow[0].b), narrow = gaussian(kBlueYellow[1].b);
  const double wideWeight = kBlueYellow[0].a * std::sqrt(kPi / kBlueYellow[0].b);
  const double narrowWeight = kBlueYellow[1].a * std::sqrt(kPi / kBlueYellow[1].b);
  const double total = wideWeight * sumOf(wide) * sumOf(wide) + narrowWeight * sumOf(narrow) * sumOf(narrow);
  out.channels[2] = filter(in.channels[2], size, scaled(wide, wideWeight / total), wide);
  const Plane more = filter(in.channels[2], size, scaled(narrow, narrowWeight / total), narrow);
  for (size_t i = 0; i < more.size(); ++i) out.channels[2][i] += more[i];
  return out;
}

/// The most of the range goes to the differences below the knee.
double compressColor(double distance, double largest) {
  const double knee = kKnee * largest;
  if (distance < knee) return distance * kKneeValue / knee;
  return kKneeValue + (distance - knee) / (largest - knee) * (1 - kKneeValue);
}

// ---- feature pipeline ----

struct Features {
  Plane edges, points;
};

/// Positive taps add up to 1, negative ones to −1.
Kernel balanced(Kernel kernel) {
  double positive = 0, negative = 0;
  for (const double tap : kernel) (tap > 0 ? positive : negative) += tap;
  for (double& tap : kernel) tap /= tap > 0 ? positive : -negative;
  return kernel;
}

Features findFeatures(const Plane& opponentY, Size size, double pixelsPerDegree) {
  const double deviation = 0.5 * kFeatureWidth * pixelsPerDegree;
  const double square = deviation * deviation;
  const int radius = static_cast<int>(std::ceil(3 * deviation));
  Kernel smooth = makeKernel(radius, [&](double i) { return std::exp(-i * i / (2 * square)); });
  const double sum = sumOf(smooth);
  const Kernel first = balanced(makeKernel(radius, [&](double i) { return -i * std::exp(-i * i / (2 * square)); }));
  const Kernel second = balanced(makeKernel(radius, [&](double i) { return (i * i / square - 1) * std::exp(-i * i / (2 * square)); }));
  for (double& tap : smooth) tap /= sum;
  Plane luminance(opponentY.size());
  for (size_t i = 0; i < luminance.size(); ++i) luminance[i] = (opponentY[i] + 16) / 116;
  const auto magnitude = [&](const Kernel& derivative) {
    Plane x = filter(luminance, size, derivative, smooth);
    const Plane y = filter(luminance, size, smooth, derivative);
    for (size_t i = 0; i < x.size(); ++i) x[i] = std::sqrt(x[i] * x[i] + y[i] * y[i]);
    return x;
  };
  return {magnitude(first), magnitude(second)};
}

// ---- both ----

Triple rgbAt(const Image& image, size_t pixel) {
  const float* p = image.data.data() + pixel * image.channels;
  if (image.channels < 3) return {static_cast<double>(p[0]), static_cast<double>(p[0]), static_cast<double>(p[0])};
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

/// `display`: linear RGB in [0, 1] of a pixel.
template <class F>
Opponent opponentOf(const Image& image, F display) {
  const size_t pixelCount = static_cast<size_t>(image.width) * image.height;
  Opponent result;
  for (Plane& channel : result.channels) channel.resize(pixelCount);
  for (size_t i = 0; i < pixelCount; ++i) {
    const Triple value = toOpponent(display(rgbAt(image, i)));
    for (size_t c = 0; c < 3; ++c) result.channels[c][i] = value[c];
  }
  return result;
}

Triple huntLabAt(const Opponent& image, size_t i) {
  Triple rgb = fromOpponent({image.channels[0][i], image.channels[1][i], image.channels[2][i]});
  for (double& value : rgb) value = std::clamp(value, 0.0, 1.0);
  return toHuntLab(rgb);
}

template <class F>
Plane errorMap(const Image& reference, const Image& test, double pixelsPerDegree, F display) {
  const Size size{static_cast<int>(reference.width), static_cast<int>(reference.height)};
  const Opponent r = opponentOf(reference, display), t = opponentOf(test, display);
  const Opponent seenR = resolve(r, size, pixelsPerDegree), seenT = resolve(t, size, pixelsPerDegree);
  const Features featuresR = findFeatures(r.channels[0], size, pixelsPerDegree);
  const Features featuresT = findFeatures(t.channels[0], size, pixelsPerDegree);
  const double largest = largestDistance();
  Plane error(r.channels[0].size());
  for (size_t i = 0; i < error.size(); ++i) {
    const double color = compressColor(colorDistance(huntLabAt(seenR, i), huntLabAt(seenT, i)), largest);
    const double difference =
        std::max(std::abs(featuresR.edges[i] - featuresT.edges[i]), std::abs(featuresR.points[i] - featuresT.points[i]));
    const double feature = std::pow(difference / std::sqrt(2.0), kFeatureExponent);
    error[i] = std::clamp(std::pow(color, 1 - feature), 0.0, 1.0);
  }
  return error;
}

void summarize(const Image& reference, const Plane& error, FlipMap& map) {
  map.error = {reference.width, reference.height, 1, {}};
  map.error.data.assign(error.begin(), error.end());
  map.mean = sumOf(error) / static_cast<double>(error.size());
  map.percentile = percentileOf(error, 0.99);
}

void check(const Image& reference, const Image& test, double pixelsPerDegree) {
  checkComparable(reference, test);
  if (!(pixelsPerDegree > 0.0) || pixelsPerDegree > 1e4) {
    throw Error(ErrorCode::BadInput, "FLIP: " + std::to_string(pixelsPerDegree) + " pixels per degree; give a number up to 10000");
  }
}

// ---- exposures ----

/// The filmic curve (p x² + q x)/(r x² + s x + u), with the factor 0.6 that undoes its built-in exposure.
struct Curve {
  double p = 0.6 * 0.6 * 2.51, q = 0.6 * 0.03, r = 0.6 * 0.6 * 2.43, s = 0.6 * 0.59, u = 0.14;
  double map(double x) const { return std::clamp((p * x * x + q * x) / (r * x * x + s * x + u), 0.0, 1.0); }
  /// Where it reaches `y`.
  double invert(double y) const {
    const double a = y * r - p, b = y * s - q, c = y * u;
    return (-b - std::sqrt(b * b - 4 * a * c)) / (2 * a);  // a < 0 for y < p/r: the positive root
  }
};

}  // namespace

FlipMap flip(const Image& reference, const Image& test, double pixelsPerDegree) {
  check(reference, test, pixelsPerDegree);
  FlipMap map;
  const auto display = [](Triple rgb) {
    for (double& value : rgb) value = std::clamp(value, 0.0, 1.0);
    return rgb;
  };
  summarize(reference, errorMap(reference, test, pixelsPerDegree, display), map);
  return map;
}

HdrFlipMap hdrFlip(const Image& reference, const Image& test, double pixelsPerDegree) {
  check(reference, test, pixelsPerDegree);
  constexpr double kBright = 0.85, kDarkest = 1e-5;
  const Curve curve;
  const size_t pixelCount = static_cast<size_t>(reference.width) * reference.height;
  Plane luminance(pixelCount);
  for (size_t i = 0; i < pixelCount; ++i) luminance[i] = std::max(multiply(kToXyz, rgbAt(reference, i))[1], 0.0);
  const auto median = luminance.begin() + static_cast<std::ptrdiff_t>((pixelCount - 1) / 2);  // the lower one of an even count
  std::nth_element(luminance.begin(), median, luminance.end());
  const double middle = std::max(*median, kDarkest);
  const double brightest = std::max(*std::max_element(median, luminance.end()), kDarkest);
  HdrFlipMap map;
  map.startExposure = std::log2(curve.invert(kBright) / brightest);
  map.stopExposure = std::log2(curve.invert(kBright) / middle);
  map.exposureCount = std::max(2u, static_cast<uint32_t>(std::ceil(map.stopExposure - map.startExposure)));
  Plane largest(pixelCount, 0.0);
  for (uint32_t i = 0; i < map.exposureCount; ++i) {
    const double stops = map.startExposure + (map.stopExposure - map.startExposure) * i / (map.exposureCount - 1);
    const double factor = std::exp2(stops);
    const auto display = [&](Triple rgb) {
      for (double& value : rgb) value = curve.map(std::max(value, 0.0) * factor);
      return rgb;
    };
    const Plane error = errorMap(reference, test, pixelsPerDegree, display);
    for (size_t k = 0; k < pixelCount; ++k) largest[k] = std::max(largest[k], error[k]);
  }
  summarize(reference, largest, map);
  return map;
}

}  // namespace radivox::image
