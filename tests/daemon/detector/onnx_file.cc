// SPDX-License-Identifier: Apache-2.0
#include "tests/daemon/detector/onnx_file.h"

#include <cstring>
#include <initializer_list>

namespace v2vouch {
namespace {

// Protobuf's wire format: key = field << 3 | type; type 0 varint, 2 bytes.
std::string Varint(std::uint64_t value) {
  std::string out;
  for (; value >= 0x80; value >>= 7U) out.push_back(static_cast<char>(value | 0x80U));
  out.push_back(static_cast<char>(value));
  return out;
}
std::string Number(int field, std::int64_t value) {
  return Varint(static_cast<std::uint64_t>(field) << 3U) +
         Varint(static_cast<std::uint64_t>(value));
}
std::string Bytes(int field, const std::string& bytes) {
  return Varint((static_cast<std::uint64_t>(field) << 3U) | 2U) + Varint(bytes.size()) + bytes;
}

// onnx.proto: TensorProto dims 1, data_type 2, name 8, raw_data 9; 1 = float, 7 = int64.
template <class T>
std::string Tensor(const std::string& name, int type, std::initializer_list<std::int64_t> dims,
                   const std::vector<T>& values) {
  std::string out;
  for (const std::int64_t dim : dims) out += Number(1, dim);
  std::string raw(values.size() * sizeof(T), '\0');
  std::memcpy(raw.data(), values.data(), raw.size());
  return out + Number(2, type) + Bytes(8, name) + Bytes(9, raw);
}

// AttributeProto: name 1, i 3, ints 8, type 20 (2 = INT, 7 = INTS).
std::string Ints(const std::string& name, std::initializer_list<std::int64_t> values) {
  std::string out = Bytes(1, name);
  for (const std::int64_t value : values) out += Number(8, value);
  return out + Number(20, 7);
}
std::string Int(const std::string& name, std::int64_t value) {
  return Bytes(1, name) + Number(3, value) + Number(20, 2);
}

// NodeProto: input 1, output 2, op_type 4, attribute 5.
std::string Node(const std::string& type, std::initializer_list<std::string> inputs,
                 const std::string& output, std::initializer_list<std::string> attributes) {
  std::string out;
  for (const std::string& input : inputs) out += Bytes(1, input);
  out += Bytes(2, output) + Bytes(4, type);
  for (const std::string& attribute : attributes) out += Bytes(5, attribute);
  return out;
}

// ValueInfoProto: name 1, type 2 { tensor_type 1 { elem_type 1, shape 2 { dim 1 { dim_value 1 }}}}.
std::string Value(const std::string& name, std::initializer_list<std::int64_t> dims) {
  std::string shape;
  for (const std::int64_t dim : dims) shape += Bytes(1, Number(1, dim));
  return Bytes(1, name) + Bytes(2, Bytes(1, Number(1, 1) + Bytes(2, shape)));
}

}  // namespace

std::string TinyYolox(int width_px, int height_px) {
  constexpr std::int64_t kRow = 7;  // Box, objectness, two classes.
  std::vector<float> weights(static_cast<std::size_t>(kRow) * 3, 0.0F);
  for (std::size_t channel = 0; channel < 3; ++channel) weights[4 * 3 + channel] = 1.0F / 765.0F;
  const std::vector<float> bias = {0.5F, 0.5F, 0.0F, 0.0F, 0.0F, 0.1F, 0.9F};
  std::string graph;
  std::int64_t cells = 0;
  std::string constants =
      Bytes(5, Tensor("w", 1, {kRow, 3, 1, 1}, weights)) + Bytes(5, Tensor("b", 1, {kRow}, bias));
  for (const std::int64_t stride : {8, 16, 32}) {
    const std::string s = std::to_string(stride);
    const std::int64_t here = (width_px / stride) * (height_px / stride);
    cells += here;
    constants += Bytes(5, Tensor<std::int64_t>("shape" + s, 7, {3}, {1, kRow, here}));
    graph +=
        Bytes(1, Node("AveragePool", {"images"}, "pool" + s,
                      {Ints("kernel_shape", {stride, stride}), Ints("strides", {stride, stride})}));
    graph += Bytes(1, Node("Conv", {"pool" + s, "w", "b"}, "conv" + s,
                           {Ints("kernel_shape", {1, 1}), Ints("strides", {1, 1})}));
    graph += Bytes(1, Node("Reshape", {"conv" + s, "shape" + s}, "rows" + s, {}));
  }
  graph += Bytes(1, Node("Concat", {"rows8", "rows16", "rows32"}, "all", {Int("axis", 2)}));
  graph += Bytes(1, Node("Transpose", {"all"}, "output", {Ints("perm", {0, 2, 1})}));
  graph += Bytes(2, "tiny") + constants;
  graph += Bytes(11, Value("images", {1, 3, height_px, width_px}));
  graph += Bytes(12, Value("output", {1, cells, kRow}));
  // ModelProto: ir_version 1, graph 7, opset_import 8 { version 2 }.
  return Number(1, 6) + Bytes(7, graph) + Bytes(8, Number(2, 11));
}

}  // namespace v2vouch
