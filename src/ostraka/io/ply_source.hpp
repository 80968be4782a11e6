// SPDX-License-Identifier: Apache-2.0
// Internal to io: the numbers of a PLY file's body in their order, from text or from bytes. Both
// classes have the same functions, so that one template reads either.
#pragma once

#include <fmt/format.h>

#include <string_view>

#include "ostraka/base/error.hpp"
#include "ostraka/io/bytes.hpp"
#include "ostraka/io/ply_header.hpp"
#include "ostraka/io/text.hpp"

namespace ostraka {

class PlyBinarySource {
  public:
    PlyBinarySource(std::span<const char> bytes, const PlyHeader& header,
                    const std::filesystem::path& path)
        : bytes_(bytes),
          offset_(header.size),
          order_(header.format == PlyFormat::BinaryBigEndian ? std::endian::big
                                                             : std::endian::little),
          path_(path) {}

    double number(PlyType type) { return next<double>(type); }
    std::int64_t integer(PlyType type) { return next<std::int64_t>(type); }
    void skip(PlyType type, std::uint64_t count) {
        require(count, size_of(type));
        offset_ += count * size_of(type);
    }
    /// @throws FormatError unless `count` numbers can follow.
    void require(std::uint64_t count, PlyType type) const { require(count, size_of(type)); }
    [[noreturn]] void fail(const std::string& problem) const {
        throw FormatError(path_, fmt::format("byte {}", offset_), problem);
    }

  private:
    void require(std::uint64_t count, std::size_t size) const {
        if (count > (bytes_.size() - offset_) / size) {
            fail("file ends too early");
        }
    }

    template <class Stored>
    Stored take() {
        require(1, sizeof(Stored));
        const Stored value = load<Stored>(bytes_.data() + offset_, order_);
        offset_ += sizeof(Stored);
        return value;
    }

    template <class Number>
    Number next(PlyType type) {
        switch (type) {
            case PlyType::Int8:
                return static_cast<Number>(take<std::int8_t>());
            case PlyType::Uint8:
                return static_cast<Number>(take<std::uint8_t>());
            case PlyType::Int16:
                return static_cast<Number>(take<std::int16_t>());
            case PlyType::Uint16:
                return static_cast<Number>(take<std::uint16_t>());
            case PlyType::Int32:
                return static_cast<Number>(take<std::int32_t>());
            case PlyType::Uint32:
                return static_cast<Number>(take<std::uint32_t>());
            case PlyType::Float32:
                return fraction<Number>(take<float>());
            case PlyType::Float64:
                return fraction<Number>(take<double>());
        }
        fail("unknown type");
    }

    template <class Number>
    Number fraction(double value) const {
        if constexpr (std::is_integral_v<Number>) {
            fail("a fraction where an index is expected");
        }
        return static_cast<Number>(value);
    }

    std::span<const char> bytes_;
    std::size_t offset_;
    std::endian order_;
    const std::filesystem::path& path_;
};

class PlyAsciiSource {
  public:
    PlyAsciiSource(std::span<const char> bytes, const PlyHeader& header,
                   const std::filesystem::path& path)
        : text_(bytes.data() + header.size, bytes.size() - header.size),
          line_(header.lines + 1),
          path_(path) {}

    double number(PlyType /*type*/) {
        const std::string_view word = next();
        double value = 0.0;
        if (!parse_number(word, value)) {
            fail(quote_word(word) + " is not a number");
        }
        return value;
    }
    std::int64_t integer(PlyType /*type*/) {
        const std::string_view word = next();
        std::int64_t value = 0;
        if (!parse_integer(word, value)) {
            fail(quote_word(word) + " is not a whole number");
        }
        return value;
    }
    void skip(PlyType /*type*/, std::uint64_t count) {
        for (std::uint64_t i = 0; i < count; ++i) {
            next();
        }
    }
    /// @throws FormatError unless `count` numbers (a digit and a blank each) can follow.
    void require(std::uint64_t count, PlyType /*type*/) const {
        if (count > (text_.size() - offset_) / 2 + 1) {
            fail("file ends too early");
        }
    }
    [[noreturn]] void fail(const std::string& problem) const {
        throw FormatError(path_, fmt::format("line {}", line_), problem);
    }

  private:
    std::string_view next() {
        while (offset_ < text_.size() && is_blank(text_[offset_])) {
            line_ += text_[offset_++] == '\n' ? 1U : 0U;
        }
        const std::size_t begin = offset_;
        while (offset_ < text_.size() && !is_blank(text_[offset_])) {
            ++offset_;
        }
        if (begin == offset_) {
            fail("file ends too early");
        }
        return text_.substr(begin, offset_ - begin);
    }

    std::string_view text_;
    std::size_t offset_ = 0;
    std::size_t line_;
    const std::filesystem::path& path_;
};

}  // namespace ostraka
