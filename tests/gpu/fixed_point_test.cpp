// shaders/shared/fixed_point.glsl against exact 64-bit sums on the host.
#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "tests/gpu/devices.h"

namespace radivox::tests {
namespace {

struct Words {
  uint32_t low, high;
  bool operator==(const Words&) const = default;
};

Words split(int64_t value) {
  const auto bits = static_cast<uint64_t>(value);
  return {static_cast<uint32_t>(bits), static_cast<uint32_t>(bits >> 32)};
}

/// From the definition: nearest integer to v · 2^fractionalBits, halves away from 0, saturated; denormal floats are 0.
int64_t toFixed(float v, int fractionalBits) {
  constexpr int64_t kMost = std::numeric_limits<int64_t>::max();
  if (!std::isfinite(v)) return std::signbit(v) ? -kMost : kMost;
  if (std::abs(v) < std::numeric_limits<float>::min()) return 0;
  const double scaled = std::ldexp(static_cast<double>(v), fractionalBits);
  if (std::abs(scaled) >= 0x1p63) return scaled < 0 ? -kMost : kMost;
  return std::llround(scaled);  // a float has 24 bits, so the double is exact
}

/// The float nearest to value · 2^-fractionalBits: the conversion from int64_t rounds to nearest even, scaling is exact.
float toFloat(int64_t value, int fractionalBits) { return std::ldexp(static_cast<float>(value), -fractionalBits); }

struct Push {
  uint32_t itemCount, sumCount, stride;
  int32_t fractionalBits;
};

struct Result {
  std::vector<Words> sums, fixedValues;
  std::vector<float> back;
};

class FixedPointTest : public oracles::GpuTest {
 protected:
  Result compute(const std::vector<float>& values, const std::vector<int64_t>& pairs, uint32_t sumCount, uint32_t stride,
                 int fractionalBits) {
    gpu::Pipeline pipeline(device(), gpu::ComputePipelineInfo{.shader = "gpu/test_fixed_point.comp",
                                                              .bindings = std::vector(5, gpu::BindingType::StorageBuffer),
                                                              .pushConstantBytes = sizeof(Push)});
    std::vector<Words> pairWords;
    for (int64_t pair : pairs) pairWords.push_back(split(pair));
    gpu::Buffer valueBuffer(device(), "values", values.size() * 4);
    gpu::Buffer sums(device(), "sums", sumCount * 8);
    gpu::Buffer fixedValues(device(), "fixed", values.size() * 8);
    gpu::Buffer back(device(), "back", values.size() * 4);
    gpu::Buffer pairBuffer(device(), "pairs", values.size() * 8);
    gpu::upload(device(), valueBuffer, values);
    gpu::upload(device(), pairBuffer, pairWords);
    run([&](gpu::Commands& commands) {
      commands.fill(sums, 0);
      commands.barrier();
      commands.bind(pipeline, {valueBuffer, sums, fixedValues, back, pairBuffer});
      commands.push(Push{static_cast<uint32_t>(values.size()), sumCount, stride, fractionalBits});
      commands.dispatchItems(values.size(), 64);
      commands.barrier();
    });
    return {gpu::downloadAs<Words>(device(), sums, sumCount), gpu::downloadAs<Words>(device(), fixedValues, values.size()),
            gpu::downloadAs<float>(device(), back, values.size())};
  }
};

TEST_F(FixedPointTest, SumsAreExactInAnyOrder) {
  constexpr size_t kCount = 60000;
  constexpr uint32_t kSums = 7;
  std::mt19937 random(5);
  std::normal_distribution<float> bell(0.f, 1.f);
  std::vector<float> values(kCount);
  // Magnitudes over many decades, both signs: low words wrap in both directions all the time.
  for (auto& value : values) value = bell(random) * std::exp2(static_cast<float>(random() % 40) - 30.f);
  std::vector<int64_t> expected(kSums, 0);
  for (size_t i = 0; i < kCount; ++i) expected[i % kSums] += toFixed(values[i], 32);
  for (uint32_t stride : {1u, 7919u, 59999u}) {  // coprime to the count: each is another order
    const Result result = compute(values, std::vector<int64_t>(kCount, 0), kSums, stride, 32);
    for (uint32_t s = 0; s < kSums; ++s) EXPECT_EQ(result.sums[s], split(expected[s])) << "sum " << s << ", stride " << stride;
  }
}

TEST_F(FixedPointTest, ConvertsEveryKindOfFloat) {
  std::vector<float> values = {0.f,
                               -0.f,
                               1.f,
                               -1.f,
                               0.5f,
                               -0.5f,
                               0x1p-32f,
                               -0x1p-32f,
                               0x1p-33f,
                               -0x1p-33f,
                               0x1.8p-33f,
                               0x1.fffffep-34f,
                               0x1p-34f,
                               0x1.8p-32f,
                               2147483520.f,
                               -2147483520.f,
                               2147483648.f,
                               -2147483648.f,
                               1e30f,
                               -1e30f,
                               1e-30f,
                               1e-42f,
                               16777215.f,
                               16777216.f,
                               0x1.fffffep-1f,
                               0x1.fffffep30f,
                               3.14159274f,
                               -2.71828175f};
  values.push_back(std::numeric_limits<float>::infinity());
  values.push_back(-std::numeric_limits<float>::infinity());
  values.push_back(std::numeric_limits<float>::quiet_NaN());
  std::mt19937 random(6);
  while (values.size() < 20000) values.push_back(std::bit_cast<float>(static_cast<uint32_t>(random())));  // every exponent and sign
  for (int fractionalBits : {32, 0, 16, 48}) {
    const Result result = compute(values, std::vector<int64_t>(values.size(), 0), 1, 1, fractionalBits);
    for (size_t i = 0; i < values.size(); ++i) {
      ASSERT_EQ(result.fixedValues[i], split(toFixed(values[i], fractionalBits))) << values[i] << " with " << fractionalBits << " bits";
    }
  }
}

TEST_F(FixedPointTest, ConvertsBackToTheNearestFloat) {
  std::vector<int64_t> pairs = {0,
                                1,
                                -1,
                                2,
                                0xffffff,
                                0x1000000,
                                0x1000001,
                                0x1000002,
                                0x1000003,
                                -0x1000001,
                                -0x1000003,
                                0x1ffffff,
                                0x7fffffff,
                                0xffffffff,
                                0x100000000,
                                0x100000001,
                                -0x100000000,
                                0x1ffffffff,
                                0x0100000080000000,
                                0x0100000080000001,
                                0x0100000180000000,
                                std::numeric_limits<int64_t>::max(),
                                std::numeric_limits<int64_t>::min(),
                                std::numeric_limits<int64_t>::min() + 1};
  std::mt19937_64 random(7);
  while (pairs.size() < 20000) pairs.push_back(static_cast<int64_t>(random()) >> (random() % 64));
  for (int i = 24; i < 63; ++i) {  // exact halves at every width, and their neighbours
    for (int64_t delta : {-1, 0, 1}) pairs[static_cast<size_t>(i * 3 + delta) + 100] = (int64_t{0x1000001} << (i - 24)) + delta;
  }
  for (int fractionalBits : {32, 0, 16, 48}) {
    const Result result = compute(std::vector<float>(pairs.size(), 0.f), pairs, 1, 1, fractionalBits);
    for (size_t i = 0; i < pairs.size(); ++i) {
      ASSERT_EQ(std::bit_cast<uint32_t>(result.back[i]), std::bit_cast<uint32_t>(toFloat(pairs[i], fractionalBits)))
          << pairs[i] << " with " << fractionalBits << " bits: " << result.back[i];
    }
  }
}

}  // namespace
}  // namespace radivox::tests
