// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace polyscalpel {

/// Reads bytes as a body and a list of cuts, makes the cuts, and checks every invariant after each. Any bytes
/// are a valid input: what is missing counts as 0. Returns what is wrong, empty where nothing is.
///
///     byte 0      the body: block, beam or ball
///     then, until the bytes end, at most 12 cuts, each:
///     byte        kind: plane, polygon, sweep at once, sweep pose by pose
///     numbers     of two bytes each, see cut_fuzzer.cpp
///
/// A number is taken from a list of hard ones (on the mesh's own planes, hardly off them, not finite), or is
/// any in [-2, 2].
std::string cutFromBytes(const std::uint8_t* data, std::size_t size);

}  // namespace polyscalpel
