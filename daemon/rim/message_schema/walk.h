// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "daemon/rim/message_schema/message_schema.h"

namespace v2vouch::message_schema {

/// Takes the values of one message in the order of the type's fields. Before every value of a type
/// its field is named; the elements of an array follow between BeginArray and EndArray.
class Visitor {
 public:
  virtual ~Visitor() = default;
  virtual void BeginStruct(const Type& /*type*/) {}
  virtual void EndStruct() {}
  virtual void Name(const Field& /*field*/) {}
  virtual void BeginArray(std::size_t /*count*/) {}
  virtual void EndArray() {}
  virtual void Integer(std::int64_t /*value*/) {}
  virtual void Boolean(bool /*value*/) {}
  virtual void Real(double /*value*/) {}
  virtual void Text(std::string_view /*value*/) {}  ///< Any bytes, without the NUL.
  /// A whole array of `byte`, in the place of its elements. `is_fixed`: its size belongs to the
  /// type, as an id's does.
  virtual void Bytes(std::span<const std::uint8_t> /*value*/, bool /*is_fixed*/) {}
};

/// Visits the values in `message`, fingerprint included. Believes no length: a count is at least 0
/// and its elements fit the bytes left, a string has its NUL and fits, nothing is left over. What
/// it visits is bounded by the size of the message.
/// @return false, with nothing visited, where the bytes are no such message.
bool Walk(const Type& type, std::span<const std::uint8_t> message, Visitor& visitor);

}  // namespace v2vouch::message_schema
