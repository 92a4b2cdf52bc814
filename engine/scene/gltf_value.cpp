// Checked access to JSON values.
#include <cmath>

#include "engine/error.h"
#include "engine/scene/gltf_document.h"

namespace radivox::scene::gltf {

void Value::fail(const std::string& message) const {
  throw Error(ErrorCode::BadInput, *file_ + ": " + (place_.empty() ? std::string("top level") : place_) + ": " + message);
}

std::optional<Value> Value::find(std::string_view key) const {
  if (!json_->is_object()) fail(std::string("should be an object, is ") + json_->type_name());
  const auto it = json_->find(std::string(key));
  if (it == json_->end()) return std::nullopt;
  return Value(*file_, *it, place_.empty() ? std::string(key) : place_ + "." + std::string(key));
}

Value Value::at(std::string_view key) const {
  auto value = find(key);
  if (!value) fail("required property \"" + std::string(key) + "\" is missing; export the file again or add it");
  return *value;
}

std::optional<Value> Value::findObject(std::string_view key) const {
  auto value = find(key);
  if (value && !value->json().is_object()) value->fail(std::string("should be an object, is ") + value->json().type_name());
  return value;
}

std::optional<Value> Value::findArray(std::string_view key) const {
  auto value = find(key);
  if (value && !value->json().is_array()) value->fail(std::string("should be an array, is ") + value->json().type_name());
  return value;
}

std::optional<Value> Value::findExtension(std::string_view name) const {
  const auto extensions = findObject("extensions");
  return extensions ? extensions->findObject(name) : std::nullopt;
}

size_t Value::size() const {
  if (!json_->is_array()) fail(std::string("should be an array, is ") + json_->type_name());
  return json_->size();
}

Value Value::operator[](size_t i) const { return Value(*file_, json_->at(i), place_ + "[" + std::to_string(i) + "]"); }

double Value::number() const {
  if (!json_->is_number()) fail(std::string("should be a number, is ") + json_->type_name());
  const double value = json_->get<double>();
  if (!std::isfinite(value)) fail("is not a finite number");
  return value;
}

uint64_t Value::whole() const {
  if (json_->is_number_unsigned()) return json_->get<uint64_t>();
  const double value = number();
  // 2^53: doubles above it no longer hold every integer.
  if (value < 0 || value != std::floor(value) || value > 9007199254740992.0)
    fail("is " + json_->dump() + ", should be a whole number, 0 or more");
  return static_cast<uint64_t>(value);
}

bool Value::flag() const {
  if (!json_->is_boolean()) fail(std::string("should be true or false, is ") + json_->type_name());
  return json_->get<bool>();
}

std::string Value::text() const {
  if (!json_->is_string()) fail(std::string("should be a string, is ") + json_->type_name());
  return json_->get<std::string>();
}

double Value::numberOr(std::string_view key, double fallback) const {
  const auto value = find(key);
  return value ? value->number() : fallback;
}

uint64_t Value::wholeOr(std::string_view key, uint64_t fallback) const {
  const auto value = find(key);
  return value ? value->whole() : fallback;
}

bool Value::flagOr(std::string_view key, bool fallback) const {
  const auto value = find(key);
  return value ? value->flag() : fallback;
}

std::string Value::textOr(std::string_view key, const std::string& fallback) const {
  const auto value = find(key);
  return value ? value->text() : fallback;
}

std::optional<size_t> Value::indexOr(std::string_view key, size_t limit, std::string_view table) const {
  const auto value = find(key);
  if (!value) return std::nullopt;
  const uint64_t index = value->whole();
  if (index >= limit) {
    value->fail("is " + std::to_string(index) + ", but the file has " + std::to_string(limit) + " " + std::string(table) +
                "; export the file again or correct the index");
  }
  return static_cast<size_t>(index);
}

size_t Value::index(std::string_view key, size_t limit, std::string_view table) const {
  at(key);
  return *indexOr(key, limit, table);
}

}  // namespace radivox::scene::gltf
