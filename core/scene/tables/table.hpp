// SPDX-License-Identifier: Apache-2.0
// Tables of keys: what a scene file calls each member of a description, which values it accepts and what it
// means. The reader, the writer, validation, keyframes, the scene cache, the JSON Schema and the reference
// all go through the same tables (docs/architecture.md). A Table holds Keys, in the order of the reference;
// for_each() visits them, and the type of a member decides by overload what is done with it.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>

#include "core/math/track.hpp"
#include "core/scene/tables/range.hpp"

namespace tessera::core {

// What a name in a scene file refers to.
enum class NamesOf { kNothing, kTextures, kMedia, kGrids };

// The values that keys accept.
struct Domain {
  Range range{};  // of numbers, and of each channel of colours
  // Of enumerations, in the order of their values; of truths, true before false.
  std::span<const std::string_view> words{};
  NamesOf names = NamesOf::kNothing;
  // Of texts that are not empty; the phrase of the range says which.
  bool (*accepts_text)(std::string_view) = nullptr;
  // The definition in the schema that describes the values, if several keys share it.
  std::string_view definition{};
  // In the reference, where that does not follow from the rest.
  std::string_view values{};
  // Of objects with a table of their own: what they are called, and what is due in place of a text.
  std::string_view kind{}, instead_of_text{};
  // After the mistake of a colour that is neither a number nor a list.
  std::string_view hint{};
};

struct KeyTraits {
  bool required = false;
  // Parameters with textures can always have keyframes.
  bool has_keyframes = false;
  // The default in the reference, where it is not a value of the member: "none".
  std::string_view otherwise{};
};

// The default is that of the member.
template <typename Owner, typename Value>
struct Key {
  std::string_view name;
  Value Owner::*member;
  const Domain& domain;
  std::string_view documentation;  // one sentence, or several, without the first capital and the last stop
  KeyTraits traits{};

  Value& of(Owner& owner) const { return owner.*member; }
  const Value& of(const Owner& owner) const { return owner.*member; }
};
template <typename Owner, typename Value, typename... Rest>
Key(std::string_view, Value Owner::*, Rest...) -> Key<Owner, Value>;

// A member with keyframes in one of the owner's tracks.
template <typename Owner, typename Value, typename Tracks>
struct TrackedKey {
  std::string_view name;
  Value Owner::*member;
  Track<Value> Tracks::*track;
  const Domain& domain;
  std::string_view documentation;
  KeyTraits traits{.has_keyframes = true};

  Value& of(Owner& owner) const { return owner.*member; }
  const Value& of(const Owner& owner) const { return owner.*member; }
};
template <typename Owner, typename Value, typename Tracks, typename... Rest>
TrackedKey(std::string_view, Value Owner::*, Track<Value> Tracks::*, Rest...)
    -> TrackedKey<Owner, Value, Tracks>;

// A member of a part of the owner.
template <typename Owner, typename Part, typename Value>
struct PartKey {
  std::string_view name;
  Part Owner::*part;
  Value Part::*member;
  const Domain& domain;
  std::string_view documentation;
  KeyTraits traits{};

  Value& of(Owner& owner) const { return owner.*part.*member; }
  const Value& of(const Owner& owner) const { return owner.*part.*member; }
};
template <typename Owner, typename Part, typename Value, typename... Rest>
PartKey(std::string_view, Part Owner::*, Value Part::*, Rest...) -> PartKey<Owner, Part, Value>;

// A key that is not that of one member; the reader of the type reads it.
struct OtherKey {
  std::string_view name;
  const Domain& domain;
  std::string_view documentation;
  KeyTraits traits{};
};

// A member without a key of its own: a name, or what follows from other keys.
template <typename Owner, typename Value>
struct Unkeyed {
  Value Owner::*member;

  Value& of(Owner& owner) const { return owner.*member; }
  const Value& of(const Owner& owner) const { return owner.*member; }
};
template <typename Owner, typename Value>
Unkeyed(Value Owner::*) -> Unkeyed<Owner, Value>;

// Whether an entry of a table has a name in scene files, and whether it has a member of an owner.
template <typename Entry>
concept Named = requires(const Entry& entry) {
  entry.name;
};
template <typename Entry, typename Owner>
concept MemberOf = requires(const Entry& entry, Owner& owner) {
  entry.of(owner);
};

// Entries of any types. A std::tuple is a class inside a class for each entry, which with tens of entries is
// most of what there is to compile; these are side by side.
template <std::size_t index, typename Entry>
struct TableEntry {
  Entry entry;
};
template <typename Indices, typename... Entries>
struct TableEntries;
template <std::size_t... indices, typename... Entries>
struct TableEntries<std::index_sequence<indices...>, Entries...> : TableEntry<indices, Entries>... {
  template <typename Visit>
  constexpr void visit_each(const Visit& visit) const {
    (visit(static_cast<const TableEntry<indices, Entries>&>(*this).entry), ...);
  }
  // `call` with all entries at once.
  template <typename Call>
  constexpr auto apply(const Call& call) const {
    return call(static_cast<const TableEntry<indices, Entries>&>(*this).entry...);
  }
};
template <typename... Entries>
struct Table : TableEntries<std::index_sequence_for<Entries...>, Entries...> {};
template <typename... Entries>
Table(Entries...) -> Table<Entries...>;

// One table of the entries of several.
template <typename... Entries>
constexpr Table<Entries...> join(const Table<Entries...>& table) {
  return table;
}
template <typename... First, typename... Second, typename... Rest>
constexpr auto join(const Table<First...>& first, const Table<Second...>& second, const Rest&... rest) {
  return first.apply([&](const First&... one) {
    return second.apply([&](const Second&... other) {
      return join(Table<First..., Second...>{{{one}..., {other}...}}, rest...);
    });
  });
}

// The keys of a type, but for "type".
template <typename T>
inline constexpr std::nullptr_t kKeys = nullptr;

template <typename T>
concept HasTable =
    !std::is_same_v<std::remove_cvref_t<decltype(kKeys<std::remove_const_t<T>>)>, std::nullptr_t>;

// Calls visit(entry) for each entry.
template <typename... Entries, typename Visit>
constexpr void for_each(const Table<Entries...>& table, const Visit& visit) {
  table.visit_each(visit);
}

// Calls visit(key, value) for each key of the table that has a member of the owner.
template <typename... Entries, typename Owner, typename Visit>
constexpr void visit_members(const Table<Entries...>& table, Owner& owner, const Visit& visit) {
  for_each(table, [&]<typename Entry>(const Entry& entry) {
    if constexpr (Named<Entry> && MemberOf<Entry, Owner>) visit(entry, entry.of(owner));
  });
}

// Calls visit(track) for each track that the keys of the table have.
template <typename... Entries, typename Tracks, typename Visit>
void visit_tracks(const Table<Entries...>& table, const Tracks& tracks, const Visit& visit) {
  for_each(table, [&](const auto& entry) {
    if constexpr (requires { tracks.*entry.track; }) visit(tracks.*entry.track);
  });
}

// `owner` as it is at a frame.
template <typename... Entries, typename Owner, typename Tracks>
Owner tracked_values_at(const Table<Entries...>& table, Owner owner, const Tracks& tracks, float frame) {
  visit_members(table, owner, [&](const auto& key, auto& value) {
    if constexpr (requires { tracks.*key.track; }) value = value_at(tracks.*key.track, frame, value);
  });
  return owner;
}

}  // namespace tessera::core
