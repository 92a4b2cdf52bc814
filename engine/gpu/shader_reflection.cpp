#include "engine/gpu/shader_reflection.h"

#include <map>

namespace radivox::gpu {

namespace {

// Opcodes and decorations of the SPIR-V specification, section 3.
enum Op : uint32_t {
  OpTypeInt = 21,
  OpTypeFloat = 22,
  OpTypeImage = 25,
  OpTypeSampledImage = 27,
  OpTypePointer = 32,
  OpVariable = 59,
  OpDecorate = 71,
};
constexpr uint32_t kDecorationBinding = 33;
constexpr uint32_t kDimBuffer = 5;

}  // namespace

void reflectImageKinds(std::span<const uint32_t> words, std::vector<ImageKind>& kinds) {
  std::map<uint32_t, TexelType> scalars;
  std::map<uint32_t, ImageKind> images;   // image and sampled-image types
  std::map<uint32_t, uint32_t> pointees;  // pointer type → type
  std::map<uint32_t, uint32_t> bindings;  // variable → binding
  for (size_t at = 5; at < words.size();) {
    const uint32_t count = words[at] >> 16;
    if (count == 0 || at + count > words.size()) return;
    const auto operand = [&](uint32_t i) { return i + 1 < count ? words[at + 1 + i] : 0u; };
    switch (words[at] & 0xffffu) {
      case OpTypeInt:
        scalars[operand(0)] = operand(2) != 0 ? TexelType::Int : TexelType::Uint;
        break;
      case OpTypeFloat:
        scalars[operand(0)] = TexelType::Float;
        break;
      case OpTypeImage:
        images[operand(0)] = {scalars[operand(1)], operand(4) != 0, operand(2) == kDimBuffer};
        break;
      case OpTypeSampledImage:
        images[operand(0)] = images[operand(1)];
        break;
      case OpTypePointer:
        pointees[operand(0)] = operand(2);
        break;
      case OpDecorate:
        if (operand(1) == kDecorationBinding) bindings[operand(0)] = operand(2);
        break;
      case OpVariable: {
        const auto image = images.find(pointees[operand(0)]);
        const auto binding = bindings.find(operand(1));
        if (image != images.end() && binding != bindings.end() && binding->second < kinds.size()) kinds[binding->second] = image->second;
        break;
      }
      default:
        break;
    }
    at += count;
  }
}

}  // namespace radivox::gpu
