// SPDX-License-Identifier: Apache-2.0
// The whole of Ostraka behind one include: build_library() offline, recognize() online.
#pragma once

#include "ostraka/io/cloud_file.hpp"
#include "ostraka/io/mesh_file.hpp"
#include "ostraka/library/build.hpp"
#include "ostraka/library/library_file.hpp"
#include "ostraka/library/retrieval.hpp"
#include "ostraka/recognition/recognize.hpp"
