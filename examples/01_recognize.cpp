// SPDX-License-Identifier: Apache-2.0
// Usage: 01_recognize SCAN MODEL...: which of the models are in the scan, and where (all in mm)?
#include <ostraka/ostraka.hpp>

#include <cstdio>

int main(int argc, char** argv) try {
    std::vector<ostraka::ModelSource> models;
    for (int i = 2; i < argc; ++i) models.push_back(ostraka::load_model(argv[i]));
    ostraka::LibrarySettings settings;
    settings.unit = ostraka::Unit::millimeter;
    settings.selection.budget = 64;
    const ostraka::ModelLibrary library = ostraka::build_library(models, settings);
    const ostraka::PointCloud scan = ostraka::read_cloud(argc > 1 ? argv[1] : "");
    for (const ostraka::RecognizedObject& object : ostraka::recognize(library, scan).objects) {
        const ostraka::Vec3d at = object.T_scene_model.translation();
        std::printf("%s at %.1f %.1f %.1f, confidence %.2f\n", object.model.c_str(), at.x(), at.y(),
                    at.z(), object.confidence);
    }
    return 0;
} catch (const ostraka::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
