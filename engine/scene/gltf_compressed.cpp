// Compressed geometry: decoded into buffers of its own, which the model's views and accessors are pointed at. Not tinygltf's decoder:
// Debian builds it without, and it indexes views, accessors and attributes by what the file says, unchecked.
#include "engine/scene/gltf_compressed.h"

#include <cstring>

#include "engine/scene/gltf_document.h"

#ifdef RADIVOX_WITH_DRACO
#include <draco/compression/decode.h>
#endif
#ifdef RADIVOX_WITH_MESHOPTIMIZER
#include <meshoptimizer.h>
#endif

namespace radivox::scene::gltf {

namespace {

constexpr const char* kDraco = "KHR_draco_mesh_compression";
constexpr const char* kMeshopt[] = {"EXT_meshopt_compression", "KHR_meshopt_compression"};

#if defined(RADIVOX_WITH_DRACO) || defined(RADIVOX_WITH_MESHOPTIMIZER)
/// Points `view` at all of a new buffer.
void putIntoBuffer(tinygltf::Model& model, tinygltf::BufferView& view, std::vector<unsigned char> bytes) {
  view.buffer = static_cast<int>(model.buffers.size());
  view.byteOffset = 0;
  view.byteLength = bytes.size();
  model.buffers.emplace_back().data = std::move(bytes);
}
#endif

#ifdef RADIVOX_WITH_MESHOPTIMIZER
/// The bytes of a compressed view; nothing when the data is broken.
std::optional<std::vector<unsigned char>> decodeMeshopt(std::span<const std::byte> from, size_t count, size_t stride,
                                                        const std::string& mode, const std::string& filter) {
  const auto* data = reinterpret_cast<const unsigned char*>(from.data());
  // Vertices take at least a bit pair for 16 bytes, indices a byte for three: what claims more is refused before memory is taken for it.
  if (stride == 0 || stride > 256 || count * stride > from.size() * 64) return std::nullopt;
  std::vector<unsigned char> out(count * stride);
  if (mode == "ATTRIBUTES") {
    if (stride % 4 != 0 || meshopt_decodeVertexBuffer(out.data(), count, stride, data, from.size()) != 0) return std::nullopt;
  } else {
    if (stride != 2 && stride != 4) return std::nullopt;
    if (mode == "TRIANGLES" && count % 3 != 0) return std::nullopt;
    const int error = mode == "TRIANGLES" ? meshopt_decodeIndexBuffer(out.data(), count, stride, data, from.size())
                                          : meshopt_decodeIndexSequence(out.data(), count, stride, data, from.size());
    if (error != 0) return std::nullopt;
  }
  if (filter == "OCTAHEDRAL") {
    if (stride != 4 && stride != 8) return std::nullopt;
    meshopt_decodeFilterOct(out.data(), count, stride);
  } else if (filter == "QUATERNION") {
    if (stride != 8) return std::nullopt;
    meshopt_decodeFilterQuat(out.data(), count, stride);
  } else if (filter == "EXPONENTIAL") {
    if (stride % 4 != 0) return std::nullopt;
    meshopt_decodeFilterExp(out.data(), count, stride);
  }
  return out;
}
#endif

#ifdef RADIVOX_WITH_DRACO
/// Index of a new accessor of `bytes`.
int addAccessor(tinygltf::Model& model, tinygltf::Accessor accessor, size_t count, std::vector<unsigned char> bytes) {
  accessor.count = count;
  accessor.byteOffset = 0;
  accessor.sparse.isSparse = false;
  accessor.bufferView = static_cast<int>(model.bufferViews.size());
  putIntoBuffer(model, model.bufferViews.emplace_back(), std::move(bytes));
  model.accessors.push_back(std::move(accessor));
  return static_cast<int>(model.accessors.size() - 1);
}

/// glTF's component type; 0 when it has none.
int componentTypeOf(draco::DataType type) {
  switch (type) {
    case draco::DT_INT8:
      return TINYGLTF_COMPONENT_TYPE_BYTE;
    case draco::DT_UINT8:
      return TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE;
    case draco::DT_INT16:
      return TINYGLTF_COMPONENT_TYPE_SHORT;
    case draco::DT_UINT16:
      return TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
    case draco::DT_UINT32:
      return TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    case draco::DT_FLOAT32:
      return TINYGLTF_COMPONENT_TYPE_FLOAT;
    default:
      return 0;
  }
}

/// A new accessor of the decoded values, one a point; -1 when the attribute is not what glTF can hold.
int addDracoAttribute(tinygltf::Model& model, const draco::Mesh& mesh, uint32_t id, int original) {
  const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(id);
  if (attribute == nullptr) return -1;
  tinygltf::Accessor accessor = model.accessors[static_cast<size_t>(original)];
  accessor.componentType = componentTypeOf(attribute->data_type());
  if (accessor.componentType == 0 || tinygltf::GetNumComponentsInType(static_cast<uint32_t>(accessor.type)) != attribute->num_components())
    return -1;
  const size_t bytesEach = static_cast<size_t>(attribute->num_components()) *
                           static_cast<size_t>(tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(accessor.componentType)));
  std::vector<unsigned char> bytes(mesh.num_points() * bytesEach);
  for (draco::PointIndex point(0); point < mesh.num_points(); ++point) {
    const draco::AttributeValueIndex value = attribute->mapped_index(point);
    const size_t from = static_cast<size_t>(attribute->GetBytePos(value));
    if (value.value() >= attribute->size() || from + bytesEach > attribute->buffer()->data_size()) return -1;
    std::memcpy(&bytes[point.value() * bytesEach], attribute->buffer()->data() + from, bytesEach);
  }
  return addAccessor(model, accessor, mesh.num_points(), std::move(bytes));
}

int addDracoIndices(tinygltf::Model& model, const draco::Mesh& mesh) {
  std::vector<uint32_t> indices;
  indices.reserve(mesh.num_faces() * 3);
  for (draco::FaceIndex face(0); face < mesh.num_faces(); ++face) {
    for (const draco::PointIndex& corner : mesh.face(face)) indices.push_back(corner.value());
  }
  std::vector<unsigned char> bytes(indices.size() * sizeof(uint32_t));
  if (!bytes.empty()) std::memcpy(bytes.data(), indices.data(), bytes.size());
  tinygltf::Accessor accessor;
  accessor.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  accessor.type = TINYGLTF_TYPE_SCALAR;
  return addAccessor(model, accessor, indices.size(), std::move(bytes));
}
#endif

}  // namespace

bool isCompression(std::string_view extension) { return extension == kDraco || extension == kMeshopt[0] || extension == kMeshopt[1]; }

bool canDecompress([[maybe_unused]] std::string_view extension) {
#ifdef RADIVOX_WITH_DRACO
  if (extension == kDraco) return true;
#endif
#ifdef RADIVOX_WITH_MESHOPTIMIZER
  if (extension == kMeshopt[0] || extension == kMeshopt[1]) return true;
#endif
  return false;
}

void Document::decompressViews() {
#ifdef RADIVOX_WITH_MESHOPTIMIZER
  for (size_t i = 0; i < noView_; ++i) {
    const tinygltf::Value* extension = findExtension(model_.bufferViews[i].extensions, kMeshopt[0]);
    if (extension == nullptr) extension = findExtension(model_.bufferViews[i].extensions, kMeshopt[1]);
    if (extension == nullptr) continue;
    const auto whole = [&](const char* key) { return static_cast<size_t>(numberOr(*extension, key, 0)); };
    const std::string place = placeOf("bufferViews", i);
    const std::string filter = extension->Has("filter") ? extension->Get("filter").Get<std::string>() : "NONE";
    const auto from = slice(whole("buffer"), whole("byteOffset"), whole("byteLength"), place);
    auto bytes = decodeMeshopt(from, whole("count"), whole("byteStride"), extension->Get("mode").Get<std::string>(), filter);
    if (!bytes) fail(place, "its compressed data is broken; compress the file again");
    putIntoBuffer(model_, model_.bufferViews[i], std::move(*bytes));
  }
#endif
}

void Document::decompressPrimitives() {
#ifdef RADIVOX_WITH_DRACO
  for (size_t m = 0; m < model_.meshes.size(); ++m) {
    for (size_t p = 0; p < model_.meshes[m].primitives.size(); ++p) {
      tinygltf::Primitive& primitive = model_.meshes[m].primitives[p];
      const tinygltf::Value* extension = findExtension(primitive.extensions, kDraco);
      if (extension == nullptr) continue;
      const std::string place = placeOf("meshes", m) + placeOf(".primitives", p) + ".extensions." + kDraco;
      const auto bytes = bufferView(static_cast<size_t>(extension->Get("bufferView").GetNumberAsInt()));
      draco::DecoderBuffer buffer;
      buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
      draco::Decoder decoder;
      const auto mesh = decoder.DecodeMeshFromBuffer(&buffer);
      if (!mesh.ok()) fail(place, "its compressed data is broken; compress the file again");
      for (const std::string& name : extension->Get("attributes").Keys()) {
        const auto original = primitive.attributes.find(name);
        if (original == primitive.attributes.end()) continue;
        const auto id = static_cast<uint32_t>(extension->Get("attributes").Get(name).GetNumberAsInt());
        const int accessor = addDracoAttribute(model_, *mesh.value(), id, original->second);
        if (accessor < 0)
          fail(place + ".attributes." + name, "is not in the compressed data as its accessor says; compress the file again");
        original->second = accessor;
      }
      primitive.indices = addDracoIndices(model_, *mesh.value());
      primitive.mode = TINYGLTF_MODE_TRIANGLES;
    }
  }
#endif
}

}  // namespace radivox::scene::gltf
