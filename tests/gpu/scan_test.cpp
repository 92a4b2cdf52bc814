#include "engine/gpu/scan.h"

#include <algorithm>
#include <numeric>
#include <random>

#include "tests/gpu/devices.h"

namespace radivox::tests {
namespace {

constexpr uint32_t kGuard = 0xdeadbeefu;
constexpr uint64_t kSmallPieces = 32768;  // what a 256 KiB binding range would ask for

std::vector<uint32_t> makeWords(size_t count, uint32_t seed, uint32_t most = 0xffffffffu) {
  std::mt19937 random(seed);
  std::vector<uint32_t> words(count);
  for (auto& word : words) word = static_cast<uint32_t>(most == 0xffffffffu ? random() : random() % (most + 1));
  return words;
}

struct ScanResult {
  std::vector<uint32_t> output;  // one guard word longer than the input
  uint64_t total = 0;
};

ScanResult scanOnDevice(gpu::Device& device, const gpu::Scan& scan, const std::vector<uint32_t>& input, bool inPlace) {
  const size_t count = input.size();
  std::vector<uint32_t> padded(input);
  padded.push_back(kGuard);
  gpu::Buffer from(device, "from", padded.size() * 4);
  gpu::Buffer to(device, "to", padded.size() * 4);
  gpu::Buffer scratch(device, "scratch", gpu::Scan::scratchBytes(count));
  gpu::Buffer total(device, "total", 24);
  gpu::upload(device, from, padded);
  gpu::upload(device, to, std::vector<uint32_t>(padded.size(), kGuard));
  gpu::upload(device, total, std::vector<uint32_t>(6, kGuard));
  oracles::runCommands(device, [&](gpu::Commands& commands) { scan.scan(commands, from, inPlace ? from : to, count, scratch, &total, 8); });
  const auto words = gpu::downloadAs<uint32_t>(device, total, 6);
  EXPECT_EQ(words[1], kGuard);
  EXPECT_EQ(words[4], kGuard);
  return {gpu::downloadAs<uint32_t>(device, inPlace ? from : to, padded.size()), words[2] | uint64_t{words[3]} << 32};
}

ScanResult scanOnHost(const std::vector<uint32_t>& input) {
  ScanResult result;
  result.output.resize(input.size());
  std::exclusive_scan(input.begin(), input.end(), result.output.begin(), 0u);
  result.output.push_back(kGuard);
  result.total = std::accumulate(input.begin(), input.end(), uint64_t{0});
  return result;
}

void expectSame(const ScanResult& actual, const ScanResult& expected, const std::string& what) {
  EXPECT_EQ(actual.total, expected.total) << what;
  const auto miss = std::mismatch(actual.output.begin(), actual.output.end(), expected.output.begin(), expected.output.end());
  EXPECT_TRUE(miss.first == actual.output.end()) << what << ": item " << miss.first - actual.output.begin();
}

class ScanTest : public BothBindingsTest {};
INSTANTIATE_TEST_SUITE_P(Bindings, ScanTest, ::testing::Values(true, false), printBinding);

TEST_P(ScanTest, EqualsExclusiveScanAtEveryLength) {
  const gpu::Scan scan(device());
  for (size_t count : {0, 1, 2, 3, 4, 5, 255, 1023, 1024, 1025, 4097, 65536, (1 << 20) - 1, 1 << 20, (1 << 20) + 1}) {
    const auto input = makeWords(count, static_cast<uint32_t>(count));
    const ScanResult expected = scanOnHost(input);
    expectSame(scanOnDevice(device(), scan, input, false), expected, std::to_string(count));
    expectSame(scanOnDevice(device(), scan, input, true), expected, std::to_string(count) + " in place");
  }
}

TEST_P(ScanTest, WorksInPieces) {
  const gpu::Scan scan(device(), kSmallPieces);
  for (size_t count : {32767, 32768, 32769, 65536, 65537, 1200003}) {
    const auto input = makeWords(count, static_cast<uint32_t>(count), 5);
    expectSame(scanOnDevice(device(), scan, input, false), scanOnHost(input), std::to_string(count));
    expectSame(scanOnDevice(device(), scan, input, true), scanOnHost(input), std::to_string(count) + " in place");
  }
}

TEST_P(ScanTest, OverflowShowsInTheHighWord) {
  const gpu::Scan scan(device());
  for (size_t count : {2, 5000, 3000000}) {
    const std::vector<uint32_t> input(count, 0xffffffffu);
    const ScanResult result = scanOnDevice(device(), scan, input, false);
    EXPECT_EQ(result.total, uint64_t{0xffffffffu} * count);
    expectSame(result, scanOnHost(input), std::to_string(count));
  }
}

TEST_P(ScanTest, NeedsNoTotal) {
  const gpu::Scan scan(device());
  const auto input = makeWords(3000, 7);
  gpu::Buffer buffer(device(), "items", input.size() * 4);
  gpu::Buffer scratch(device(), "scratch", gpu::Scan::scratchBytes(input.size()));
  gpu::upload(device(), buffer, input);
  run([&](gpu::Commands& commands) { scan.scan(commands, buffer, buffer, input.size(), scratch); });
  auto expected = scanOnHost(input).output;
  expected.pop_back();
  EXPECT_EQ(gpu::downloadAs<uint32_t>(device(), buffer, input.size()), expected);
}

// Two scans in one command buffer, the second of the first's result: scan() itself must order them.
TEST_P(ScanTest, OrdersItselfAfterWhatCameBefore) {
  const gpu::Scan scan(device());
  const std::vector<uint32_t> input(5000, 1);
  gpu::Buffer a(device(), "a", input.size() * 4);
  gpu::Buffer b(device(), "b", input.size() * 4);
  gpu::Buffer scratch(device(), "scratch", gpu::Scan::scratchBytes(input.size()));
  run([&](gpu::Commands& commands) {
    commands.fill(a, 1);
    scan.scan(commands, a, b, input.size(), scratch);
    scan.scan(commands, b, a, input.size(), scratch);
  });
  const auto result = gpu::downloadAs<uint32_t>(device(), a, input.size());
  for (uint32_t i = 0; i < input.size(); ++i) ASSERT_EQ(result[i], i * (i - 1) / 2) << i;
}

struct CompactResult {
  std::vector<uint32_t> indices;  // as many as the output holds
  std::vector<uint32_t> count;    // the number, then dispatch arguments
};

CompactResult compactOnDevice(gpu::Device& device, const gpu::Scan& scan, const std::vector<uint32_t>& bits, uint64_t itemCount,
                              size_t capacity, uint32_t groupSize) {
  gpu::Buffer from(device, "bits", bits.size() * 4);
  gpu::Buffer output(device, "indices", std::max<size_t>(capacity, 1) * 4);
  gpu::Buffer count(device, "count", 16);
  gpu::Buffer scratch(device, "scratch", gpu::Scan::compactScratchBytes(itemCount));
  gpu::upload(device, from, bits);
  gpu::upload(device, output, std::vector<uint32_t>(output.bytes() / 4, kGuard));
  oracles::runCommands(device,
                       [&](gpu::Commands& commands) { scan.compactBits(commands, from, itemCount, output, count, groupSize, scratch); });
  return {gpu::downloadAs<uint32_t>(device, output, capacity), gpu::downloadAs<uint32_t>(device, count, 4)};
}

std::vector<uint32_t> compactOnHost(const std::vector<uint32_t>& bits, uint64_t itemCount) {
  std::vector<uint32_t> indices;
  for (uint64_t i = 0; i < itemCount; ++i) {
    if ((bits[i / 32] >> (i % 32) & 1u) != 0) indices.push_back(static_cast<uint32_t>(i));
  }
  return indices;
}

void expectCompaction(gpu::Device& device, const gpu::Scan& scan, const std::vector<uint32_t>& bits, uint64_t itemCount) {
  const auto expected = compactOnHost(bits, itemCount);
  const auto n = static_cast<uint32_t>(expected.size());
  auto guarded = expected;
  guarded.push_back(kGuard);
  const CompactResult result = compactOnDevice(device, scan, bits, itemCount, guarded.size(), 64);
  const uint32_t groups = (n + 63) / 64;
  const std::vector<uint32_t> arguments = {n, std::min(groups, 32768u), std::max((groups + 32767) / 32768, 1u), 1};
  EXPECT_EQ(result.count, arguments) << itemCount << " bits";
  EXPECT_TRUE(result.indices == guarded) << itemCount << " bits, " << n << " set";
}

TEST_P(ScanTest, CompactsBitsOfEveryLength) {
  const gpu::Scan scan(device());
  for (uint64_t itemCount : {0u, 1u, 31u, 32u, 33u, 1000u, 32767u, 32768u, 32769u, (1u << 20) + 7u, 3u << 20}) {
    // Words past the end and bits past the last item are set: they must not be seen.
    auto bits = makeWords(itemCount / 32 + 2, static_cast<uint32_t>(itemCount));
    bits.back() = ~0u;
    if (itemCount % 32 != 0) bits[itemCount / 32] |= ~0u << itemCount % 32;
    expectCompaction(device(), scan, bits, itemCount);
    expectCompaction(device(), scan, std::vector<uint32_t>(bits.size(), 0), itemCount);
    expectCompaction(device(), scan, std::vector<uint32_t>(bits.size(), ~0u), itemCount);
  }
}

TEST_P(ScanTest, CompactsInPieces) {
  const gpu::Scan scan(device(), kSmallPieces);
  for (uint64_t itemCount : {32768u * 32u, 32768u * 32u + 1u, 5000017u}) {
    const auto all = makeWords(itemCount / 32 + 1, 3);
    const auto other = makeWords(itemCount / 32 + 1, 4);
    auto sparse = all;
    for (size_t i = 0; i < sparse.size(); ++i) sparse[i] &= other[i] & other[sparse.size() - 1 - i];
    expectCompaction(device(), scan, sparse, itemCount);
  }
}

TEST_P(ScanTest, CompactionThatDoesNotFitIsCountedAndCut) {
  const gpu::Scan scan(device());
  const auto bits = makeWords(300, 11);
  const auto expected = compactOnHost(bits, 9600);
  ASSERT_GT(expected.size(), 100u);
  const CompactResult result = compactOnDevice(device(), scan, bits, 9600, 100, 32);
  EXPECT_EQ(result.count[0], expected.size());
  EXPECT_TRUE(std::equal(result.indices.begin(), result.indices.end(), expected.begin()));
}

// More than a binding shows on lavapipe (128 MiB), and on a device of larger range simply long.
TEST_P(ScanTest, SlowLongerThanABinding) {
  const gpu::Scan scan(device());
  const auto input = makeWords((size_t{36} << 20) + 5, 1, 200);
  expectSame(scanOnDevice(device(), scan, input, true), scanOnHost(input), "36 Mi items");
  auto bits = makeWords((size_t{34} << 20) / 16, 2);
  expectCompaction(device(), scan, bits, bits.size() * 32 - 3);
}

}  // namespace
}  // namespace radivox::tests
