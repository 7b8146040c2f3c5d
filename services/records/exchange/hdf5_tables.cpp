#ifdef DYNCAL_HAVE_HDF5

#include "services/records/exchange/hdf5_tables.hpp"

#include <initializer_list>
#include <type_traits>

namespace dyncal::inline records {
namespace {

template <class Number>
hid_t number_type() {
  if constexpr (std::is_floating_point_v<Number>) {
    return H5T_NATIVE_DOUBLE;
  } else if constexpr (sizeof(Number) == 8) {
    return std::is_signed_v<Number> ? H5T_NATIVE_INT64 : H5T_NATIVE_UINT64;
  } else if constexpr (sizeof(Number) == 4) {
    return std::is_signed_v<Number> ? H5T_NATIVE_INT32 : H5T_NATIVE_UINT32;
  } else {
    return H5T_NATIVE_UINT8;
  }
}

struct Member {
  const char* name;
  std::size_t offset;
  hid_t type;
};

Hdf5Handle compound(std::size_t bytes, std::initializer_list<Member> members) {
  Hdf5Handle type(H5Tcreate(H5T_COMPOUND, bytes), H5Tclose);
  for (const Member& member : members) {
    H5Tinsert(type.id(), member.name, member.offset, member.type);
  }
  return type;
}

} // namespace

// NOLINTNEXTLINE(cppcoreguidelines-macro-usage): name, place and type of one member, once
#define DYNCAL_MEMBER(Table, member)                                                               \
  Member {                                                                                         \
#member, offsetof(Table, member), number_type < decltype(Table::member)>()                     \
  }

template <>
Hdf5Handle hdf5_type<Hdf5Shot>() {
  using T = Hdf5Shot;
  return compound(sizeof(T),
                  {DYNCAL_MEMBER(T, session), DYNCAL_MEMBER(T, shot),
                   DYNCAL_MEMBER(T, first_column), DYNCAL_MEMBER(T, trigger_utc_ns),
                   DYNCAL_MEMBER(T, received_utc_ns), DYNCAL_MEMBER(T, first_sample_s),
                   DYNCAL_MEMBER(T, interval_s), DYNCAL_MEMBER(T, sample_count),
                   DYNCAL_MEMBER(T, step), DYNCAL_MEMBER(T, attempt), DYNCAL_MEMBER(T, run),
                   DYNCAL_MEMBER(T, acknowledged_run), DYNCAL_MEMBER(T, end_of_stream)});
}

template <>
Hdf5Handle hdf5_type<Hdf5Excitation>() {
  using T = Hdf5Excitation;
  return compound(sizeof(T),
                  {DYNCAL_MEMBER(T, run), DYNCAL_MEMBER(T, step), DYNCAL_MEMBER(T, repetition),
                   DYNCAL_MEMBER(T, attempt), DYNCAL_MEMBER(T, state),
                   DYNCAL_MEMBER(T, frequency_hz), DYNCAL_MEMBER(T, level_m_s2),
                   DYNCAL_MEMBER(T, window_begin_utc_ns), DYNCAL_MEMBER(T, window_end_utc_ns)});
}

template <>
Hdf5Handle hdf5_type<Hdf5Result>() {
  using T = Hdf5Result;
  return compound(sizeof(T),
                  {DYNCAL_MEMBER(T, run), DYNCAL_MEMBER(T, channel), DYNCAL_MEMBER(T, step),
                   DYNCAL_MEMBER(T, repetition), DYNCAL_MEMBER(T, valid), DYNCAL_MEMBER(T, lost),
                   DYNCAL_MEMBER(T, frequency_hz), DYNCAL_MEMBER(T, level_m_s2),
                   DYNCAL_MEMBER(T, magnitude), DYNCAL_MEMBER(T, u_magnitude),
                   DYNCAL_MEMBER(T, phase_rad), DYNCAL_MEMBER(T, u_phase_rad),
                   DYNCAL_MEMBER(T, attempt)});
}

#undef DYNCAL_MEMBER

} // namespace dyncal::inline records

#endif
