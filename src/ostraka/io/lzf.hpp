// SPDX-License-Identifier: Apache-2.0
// Internal to io: the decompressor of LZF (Marc Lehmann's LibLZF format), as PCD files use it.
// A control byte below 32 copies control + 1 literal bytes. Else it repeats earlier output: its
// upper three bits are the length - 2 (7: the next byte is added), the lower five and the next byte
// are the distance back - 1.
#pragma once

#include <span>

namespace ostraka {

/// The most output bytes that one input byte can make: 264 bytes from three.
inline constexpr std::size_t kLzfMostExpansion = 88;

/// Fills `output`. False if the input is damaged or doesn't make exactly output.size() bytes.
bool decompress_lzf(std::span<const char> input, std::span<char> output);

}  // namespace ostraka
