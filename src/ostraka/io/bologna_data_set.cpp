// SPDX-License-Identifier: Apache-2.0
// The data sets of Tombari, Salti, Di Stefano. Performance Evaluation of 3D Keypoint Detectors.
// IJCV 102, 2013. Their files name paths on the authors' disk, so files are sought by name.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

#include "ostraka/base/error.hpp"
#include "ostraka/io/bytes.hpp"
#include "ostraka/io/data_set_readers.hpp"
#include "ostraka/io/folder_files.hpp"
#include "ostraka/io/ini_file.hpp"
#include "ostraka/io/text.hpp"
#include "ostraka/io/xf_file.hpp"

namespace ostraka {
namespace {

using Path = std::filesystem::path;

constexpr int kMostModels = 1000;  // in a scene

// How the Stanford repository's files begin, and what people call the models.
struct KnownName {
    std::string_view begin;  // of name_key()
    std::string_view name;
};
constexpr std::array<KnownName, 6> kStanford = {{{"bunzipper", "bunny"},
                                                 {"dragonvrip", "dragon"},
                                                 {"happyvrip", "buddha"},
                                                 {"armadillo", "armadillo"},
                                                 {"xyzrgbdragon", "asian_dragon"},
                                                 {"xyzrgbstatuette", "thai_statue"}}};

std::string_view known_name(std::string_view stem) {
    const std::string key = name_key(stem);
    for (const KnownName& known : kStanford) {
        if (key.starts_with(known.begin)) return known.name;
    }
    return stem;
}

// "a/b\c.ply" is "c.ply", on whatever system it was written.
Path file_name(const std::string& path) {
    return Path(path.substr(path.find_last_of("/\\") + 1));
}

struct Folder {
    Path root;
    std::vector<Path> files;
    bool many = false;  // configurations in more than one folder: their scenes' names may repeat
};

// A configuration that is being read.
struct Configuration {
    const Path& path;
    const IniFile& values;
    const Folder& folder;

    const std::string& value(const std::string& key) const {
        const auto found = values.find(key);
        if (found == values.end()) throw FormatError(path, "file", "has no " + key);
        return found->second;
    }

    // The files that `matches`, those beside the configuration if there are any.
    template <class Matches>
    std::vector<Path> find(const Matches& matches) const {
        std::vector<Path> beside;
        std::vector<Path> elsewhere;
        for (const Path& file : folder.files) {
            if (!matches(file)) continue;
            (file.parent_path() == path.parent_path() ? beside : elsewhere).push_back(file);
        }
        return beside.empty() ? elsewhere : beside;
    }
};

// The mesh of the same name, or else of the same known name; empty if there is none.
Path model_file(const Configuration& configuration, const Path& wanted) {
    const std::string key = name_key(wanted.stem().string());
    const std::string known = name_key(known_name(wanted.stem().string()));
    for (const std::string& name : {key, known}) {
        const std::vector<Path> found = configuration.find([&](const Path& file) {
            return is_mesh_file(file) && name_key(file.stem().string()) == name;
        });
        if (!found.empty()) return found.front();
    }
    const std::vector<Path> found = configuration.find([&](const Path& file) {
        return is_mesh_file(file) && name_key(known_name(file.stem().string())) == known;
    });
    return found.empty() ? Path() : found.front();
}

RecordedObject object_from(const Configuration& configuration, int number, DataSet& set) {
    const std::string key = fmt::format("MODELS/MODEL_{}", number);
    const Path wanted = file_name(configuration.value(key));
    const Path mesh = model_file(configuration, wanted);
    const std::string name =
        mesh.empty() ? std::string(known_name(wanted.stem().string())) : mesh.stem().string();
    const Path truth = file_name(configuration.value(key + "_GROUNDTRUTH"));
    const std::vector<Path> found =
        configuration.find([&](const Path& file) { return file.filename() == truth; });
    if (found.empty()) {
        throw FileError(configuration.path.parent_path() / truth,
                        "isn't there, but " + configuration.path.filename().string() + " names it");
    }
    RecordedObject object{.model = model_of_name(set, name),
                          .T_scene_model = read_xf(found.front())};
    set.models[object.model].file = mesh;
    return object;
}

// A scene for each noise level whose scan is there: Scene0_0.1.ply and Scene0_0.5.ply for
// Scene0.ply.
void add_scenes(const Configuration& configuration, DataSet& set) {
    const std::string& count = configuration.value("MODELS/NUMBER");
    const std::optional<int> number = whole_number(count);
    if (!number || *number > kMostModels) {
        throw FormatError(configuration.path, "MODELS/NUMBER",
                          quote_word(count) + " is not a usable number of models");
    }
    RecordedScene scene;
    for (int i = 0; i < *number; ++i) {
        scene.objects.push_back(object_from(configuration, i, set));
    }
    const std::string stem = file_name(configuration.value("SCENE/PATH")).stem().string();
    const std::string prefix = configuration.folder.many
                                   ? configuration.path.parent_path()
                                             .lexically_relative(configuration.folder.root)
                                             .generic_string() +
                                         "/"
                                   : "";
    const std::vector<Path> scans = configuration.find([&](const Path& file) {
        const std::string own = file.stem().string();
        return is_cloud_file(file) && (own == stem || own.starts_with(stem + "_"));
    });
    for (const Path& scan : scans) {
        scene.name = prefix + scan.stem().string();
        scene.scan = scan;
        set.scenes.push_back(scene);
    }
    if (scans.empty()) {
        scene.name = prefix + stem;
        set.scenes.push_back(scene);
    }
}

bool is_configuration(const Path& path) {
    return lower_extension(path) == ".ini" && name_key(path.stem().string()).starts_with("config");
}

}  // namespace

std::optional<DataSet> open_bologna(const Path& folder) {
    Folder content{folder, list_files(folder, kDataSetDepth)};
    std::vector<std::pair<Path, IniFile>> configurations;
    std::set<Path> folders;
    for (const Path& file : content.files) {
        if (!is_configuration(file)) continue;
        IniFile values = parse_ini(read_file(file).span(), file);
        if (!values.contains("SCENE/PATH") && !values.contains("MODELS/NUMBER")) continue;
        configurations.emplace_back(file, std::move(values));
        folders.insert(file.parent_path());
    }
    if (configurations.empty()) return std::nullopt;
    content.many = folders.size() > 1;
    DataSet set{.kind = DataSetKind::bologna, .unit = Unit::meter};
    for (const auto& [path, values] : configurations) {
        add_scenes({path, values, content}, set);
    }
    std::stable_sort(set.scenes.begin(), set.scenes.end(),
                     [](const RecordedScene& a, const RecordedScene& b) {
                         return natural_less(a.name, b.name);
                     });
    sort_models(set);
    return set;
}

}  // namespace ostraka
