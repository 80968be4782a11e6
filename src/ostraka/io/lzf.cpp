// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/lzf.hpp"

#include <cstdint>
#include <cstring>

namespace ostraka {

bool decompress_lzf(std::span<const char> input, std::span<char> output) {
    std::size_t in = 0;
    std::size_t out = 0;
    const auto next = [&] { return static_cast<std::uint8_t>(input[in++]); };
    while (in < input.size()) {
        const std::size_t control = next();
        if (control < 32) {
            const std::size_t length = control + 1;
            if (length > input.size() - in || length > output.size() - out) {
                return false;
            }
            std::memcpy(output.data() + out, input.data() + in, length);
            in += length;
            out += length;
            continue;
        }
        std::size_t length = (control >> 5) + 2;
        const std::size_t operands = length == 9 ? 2 : 1;
        if (operands > input.size() - in) {
            return false;
        }
        length += operands == 2 ? next() : 0U;
        const std::size_t distance = ((control & 31U) << 8) + next() + 1;
        if (distance > out || length > output.size() - out) {
            return false;
        }
        // Byte by byte, because the source may overlap what is being written.
        for (const std::size_t end = out + length; out < end; ++out) {
            output[out] = output[out - distance];
        }
    }
    return out == output.size();
}

}  // namespace ostraka
