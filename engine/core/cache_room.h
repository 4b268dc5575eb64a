#pragma once
// Room in a folder of files that can all be made again.
#include <cstdint>
#include <filesystem>

namespace hl {

/// Removes files beside `keep` that have its extension, those not written for longest first, until all files of the folder together hold no more than `mostBytes`. Never `keep` itself.
/// What can't be looked at or removed is passed over.
void makeRoom(const std::filesystem::path& keep, uint64_t mostBytes);

}  // namespace hl
