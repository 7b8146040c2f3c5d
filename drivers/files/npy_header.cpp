#include "drivers/files/npy_header.hpp"

#include <algorithm>
#include <charconv>

namespace dyncal::drivers::files {
namespace {

// Reads the few forms of Python's literals that NumPy writes: {'descr': [('t_ns', '<i8'), ...],
// 'fortran_order': False, 'shape': (12,), }
class LiteralReader {
public:
  explicit LiteralReader(std::string_view text) : text_(text) {}

  bool take(char c) {
    skip_blanks();
    if (!text_.starts_with(c)) {
      return false;
    }
    text_.remove_prefix(1);
    return true;
  }

  // With the escapes that Python's repr() writes; u'...' is Python 2's.
  bool take_text(std::string& value) {
    skip_blanks();
    if (text_.starts_with("u'") || text_.starts_with("u\"")) {
      text_.remove_prefix(1);
    }
    const char quote = take('\'') ? '\'' : take('"') ? '"' : '\0';
    std::string read;
    for (std::size_t i = 0; quote != '\0' && i < text_.size(); ++i) {
      if (text_[i] == quote) {
        text_.remove_prefix(i + 1);
        value = std::move(read);
        return true;
      }
      if (text_[i] != '\\') {
        read += text_[i];
      } else if (!take_escape(i, read)) {
        return false;
      }
    }
    return false;
  }

  bool take_word(std::string_view word) {
    skip_blanks();
    if (!text_.starts_with(word)) {
      return false;
    }
    text_.remove_prefix(word.size());
    return true;
  }

  // Python 2 writes L behind a long one.
  bool take_count(std::size_t& value) {
    skip_blanks();
    const auto [end, status] = std::from_chars(text_.data(), text_.data() + text_.size(), value);
    if (status != std::errc()) {
      return false;
    }
    text_.remove_prefix(static_cast<std::size_t>(end - text_.data()));
    text_.remove_prefix(text_.starts_with('L') ? 1 : 0);
    return true;
  }

private:
  // Of a backslash at `at`, which is moved on to the last character of the escape.
  bool take_escape(std::size_t& at, std::string& to) const {
    const char kind = at + 1 < text_.size() ? text_[at + 1] : '\0';
    const std::size_t digits = kind == 'x' ? 2 : kind == 'u' ? 4 : 0;
    if (digits > 0) {
      const std::string_view code = text_.substr(at + 2, digits);
      unsigned value = 0;
      const auto [end, status] = std::from_chars(code.data(), code.data() + code.size(), value, 16);
      if (status != std::errc() || code.size() < digits || end != code.data() + digits) {
        return false;
      }
      append_utf8(value, to);
      at += 1 + digits;
      return true;
    }
    constexpr std::string_view kinds = "\\'\"ntr", stand_for = "\\'\"\n\t\r";
    const std::size_t place = kinds.find(kind);
    if (place == std::string_view::npos) {
      return false;
    }
    to += stand_for[place];
    ++at;
    return true;
  }

  static void append_utf8(unsigned code, std::string& to) {
    const auto byte = [&to](unsigned value) { to += static_cast<char>(value); };
    if (code < 0x80U) {
      byte(code);
    } else if (code < 0x800U) {
      byte(0xC0U | code >> 6U);
      byte(0x80U | (code & 0x3FU));
    } else {
      byte(0xE0U | code >> 12U);
      byte(0x80U | (code >> 6U & 0x3FU));
      byte(0x80U | (code & 0x3FU));
    }
  }

  void skip_blanks() {
    text_.remove_prefix(std::min(text_.find_first_not_of(" \n"), text_.size()));
  }
  std::string_view text_;
};

bool read_type(std::string_view type, NpyField& field) {
  if (type.size() < 3 || (type[0] != '<' && type[0] != '|')) {
    return false;
  }
  field.kind = type[1];
  const auto [end, status] =
      std::from_chars(type.data() + 2, type.data() + type.size(), field.size);
  if (status != std::errc() || end != type.data() + type.size()) {
    return false;
  }
  const bool integer = field.kind == 'i' || field.kind == 'u';
  const bool known_size =
      field.size == 8 || field.size == 4 || (integer && (field.size == 2 || field.size == 1));
  return field.kind == 'V' || ((integer || field.kind == 'f') && known_size);
}

tl::expected<std::vector<NpyField>, std::string> read_fields(LiteralReader& reader) {
  if (!reader.take('[')) {
    return tl::unexpected<std::string>(
        "holds no structured array; its rows must have named fields, one of them t_ns");
  }
  std::vector<NpyField> fields;
  std::size_t place = 0;
  while (reader.take('(')) {
    NpyField field;
    std::string type;
    if (!reader.take_text(field.name) || !reader.take(',') || !reader.take_text(type) ||
        !reader.take(')')) {
      return tl::unexpected("has a field '" + field.name + "' that is not a plain number");
    }
    if (!read_type(type, field)) {
      return tl::unexpected(
          "has a field '" + field.name + "' of type '" + type +
          "'; little-endian integers and floating-point numbers of up to 8 bytes can be read");
    }
    field.place = place;
    place += field.size;
    fields.push_back(std::move(field));
    reader.take(',');
  }
  if (fields.empty() || !reader.take(']')) {
    return tl::unexpected<std::string>("has a header that cannot be read");
  }
  return fields;
}

bool read_shape(LiteralReader& reader, std::size_t& rows) {
  return reader.take('(') && reader.take_count(rows) && reader.take(',') && reader.take(')');
}

} // namespace

tl::expected<NpyHeader, std::string> NpyHeader::of(std::string_view file) {
  constexpr std::string_view magic = "\x93NUMPY";
  const auto byte = [&](std::size_t i) {
    return static_cast<std::size_t>(static_cast<unsigned char>(file[i]));
  };
  if (!file.starts_with(magic) || file.size() < 12 || byte(6) < 1 || byte(6) > 3) {
    return tl::unexpected<std::string>("is not a NumPy file");
  }
  const bool short_length = byte(6) == 1;
  const std::size_t begin = short_length ? 10 : 12;
  const std::size_t length =
      byte(8) + (byte(9) << 8U) + (short_length ? 0 : (byte(10) << 16U) + (byte(11) << 24U));
  if (length > file.size() - begin) {
    return tl::unexpected<std::string>("ends within its header");
  }
  NpyHeader header;
  header.header_bytes = begin + length;
  LiteralReader reader(file.substr(begin, length));
  bool has_rows = false;
  reader.take('{');
  for (std::string key; reader.take_text(key) && reader.take(':'); reader.take(',')) {
    if (key == "descr") {
      auto fields = read_fields(reader);
      if (!fields) {
        return tl::unexpected(fields.error());
      }
      header.fields = std::move(*fields);
    } else if (key == "shape") {
      has_rows = read_shape(reader, header.rows);
    } else if (key != "fortran_order" || !(reader.take_word("False") || reader.take_word("True"))) {
      break;
    }
  }
  if (header.fields.empty() || !has_rows || !reader.take('}')) {
    return tl::unexpected<std::string>("holds no array of one dimension with named fields");
  }
  header.row_bytes = header.fields.back().place + header.fields.back().size;
  if (header.rows > (file.size() - header.header_bytes) / header.row_bytes) {
    return tl::unexpected("ends before its " + std::to_string(header.rows) + " rows do");
  }
  return header;
}

} // namespace dyncal::drivers::files
