// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/recognize.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "recognition/recognition_testing.hpp"

namespace ostraka {
namespace {

using namespace recognition_testing;

const RecognizedObject* find(const Recognition& recognition, std::uint32_t model) {
    for (const RecognizedObject& object : recognition.objects) {
        if (object.model_index == model) return &object;
    }
    return nullptr;
}

// Every true object once, within 2 % of its diameter, and nothing else.
// @param rim  share of a silhouette that lies in cells at its rim, where nothing can be said.
void expect_all(const Recognition& recognition, const SimulatedScene& scene, double rim = 0.2) {
    EXPECT_EQ(recognition.objects.size(), scene.objects.size());
    for (const TrueObject& truth : scene.objects) {
        const RecognizedObject* object = find(recognition, truth.model);
        ASSERT_NE(object, nullptr) << library().models[truth.model].name;
        EXPECT_EQ(object->model, library().models[truth.model].name);
        EXPECT_LT(pose_error(truth.model, truth.T_scene_model, object->T_scene_model), 0.02);
        EXPECT_GE(object->confidence, 0.5);
        EXPECT_LE(object->confidence, 1.0);
        EXPECT_NEAR(object->visible_fraction, truth.visible_fraction, rim);
        EXPECT_TRUE(object->source == "segment" || object->source == "keypoints" ||
                    object->source == "faces");
    }
}

TEST(Recognize, FindsWhatStandsOnATable) {
    const Recognizer recognizer(library());
    for (std::uint64_t number = 0; number < 4; ++number) {
        const SimulatedScene scene = tabletop({kPlate, kCorner}, number);
        const Recognition result = recognizer.recognize(scene.cloud);
        EXPECT_TRUE(result.table_found);
        EXPECT_GT(result.scan_points, 500U);
        expect_all(result, scene);
    }
}

TEST(Recognize, FindsASingleObjectInFrontOfNothing) {
    const Recognizer recognizer(library());
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
        const SimulatedScene scene = alone(static_cast<std::uint32_t>(seed % 2), seed);
        const Recognition result = recognizer.recognize(scene.cloud, {.min_confidence = 0.5});
        EXPECT_FALSE(result.table_found);
        expect_all(result, scene);
        // Of the third only faces toward the sensor are seen, but its outline is.
        ASSERT_EQ(result.objects.size(), 1U);
        EXPECT_GT(result.objects[0].confidence, RecognitionSettings{}.min_confidence);
    }
}

TEST(Recognize, FindsTwoOfTheSameModel) {
    const SimulatedScene scene = tabletop({kCorner, kCorner}, 2);
    const Recognition result = recognize(library(), scene.cloud);
    ASSERT_EQ(result.objects.size(), 2U);
    for (const TrueObject& truth : scene.objects) {
        double best = 1.0;
        for (const RecognizedObject& object : result.objects) {
            best = std::min(best, pose_error(kCorner, truth.T_scene_model, object.T_scene_model));
        }
        EXPECT_LT(best, 0.02);
    }
}

TEST(Recognize, EachSourceAloneFindsPlainObjects) {
    const SimulatedScene scene = tabletop({kPlate, kCorner}, 1);
    const Recognizer recognizer(library());
    RecognitionSettings none;
    none.use_keypoints = none.use_segments = none.use_faces = false;
    EXPECT_TRUE(recognizer.recognize(scene.cloud, none).objects.empty());
    for (bool RecognitionSettings::*source :
         {&RecognitionSettings::use_keypoints, &RecognitionSettings::use_segments,
          &RecognitionSettings::use_faces}) {
        RecognitionSettings settings = none;
        settings.*source = true;
        expect_all(recognizer.recognize(scene.cloud, settings), scene);
    }
}

TEST(Recognize, NoiseOfAQuarterOfTheSamplingDistanceIsForgiven) {
    TabletopSettings settings;
    settings.spacing = 1.4;
    settings.min_elevation = 0.7;
    settings.sensor.ranging.noise = 0.25 * library().settings.sampling;
    const std::vector<std::uint32_t> chosen = {kPlate, kCorner};
    const SimulatedScene scene = simulate_tabletop(models(), chosen, 4, settings);
    expect_all(recognize(library(), scene.cloud), scene);
}

TEST(Recognize, PixelsFartherApartThanTheLibrarysPointsAreEnough) {
    TabletopSettings settings;
    settings.spacing = 1.4;
    settings.min_elevation = 0.7;
    settings.distance = 3.0;
    settings.camera = resized(settings.camera, 140);
    const Recognizer recognizer(library());
    const std::vector<std::uint32_t> chosen = {kPlate, kCorner};
    for (std::uint64_t number = 0; number < 3; ++number) {
        const SimulatedScene scene = simulate_tabletop(models(), chosen, number, settings);
        const double pixel = scene.cloud.points.front().norm() / settings.camera.fx;
        EXPECT_GT(pixel, 1.4 * library().settings.sampling);
        // From above only flat faces are seen of the last: these slide.
        expect_all(recognizer.recognize(scene.cloud, {.min_confidence = 0.5}), scene, 0.35);
    }
}

TEST(Recognize, TurningModelsAndSceneTurnsThePoses) {
    std::vector<ModelSource> turned = testing::simple_models();
    std::vector<Pose> T_new_old;
    for (std::size_t m = 0; m < turned.size(); ++m) {
        Random random(30, m);
        Pose pose = Pose::Identity();
        pose.linear() = random.rotation();
        pose.translation() = 400.0 * random.direction();
        turned[m].mesh = transformed(turned[m].mesh, pose);
        T_new_old.push_back(pose);
    }
    const ModelLibrary other = build_library(turned, testing::quick_settings());
    const Recognizer before(library());
    const Recognizer after(other);
    for (std::uint64_t number = 0; number < 3; ++number) {
        const SimulatedScene scene = tabletop({kPlate, kCorner}, number);
        Random random(number, 77);
        Pose T_turned_scene = Pose::Identity();
        T_turned_scene.linear() = random.rotation();
        T_turned_scene.translation() = 700.0 * random.direction();
        const Recognition a = before.recognize(scene.cloud);
        const Recognition b = after.recognize(transformed(scene.cloud, T_turned_scene));
        EXPECT_EQ(a.table_found, b.table_found);
        ASSERT_EQ(a.objects.size(), b.objects.size());
        for (const RecognizedObject& object : a.objects) {
            const RecognizedObject* twin = find(b, object.model_index);
            ASSERT_NE(twin, nullptr);
            EXPECT_EQ(twin->model, object.model);
            const Pose expected =
                T_turned_scene * object.T_scene_model * T_new_old[object.model_index].inverse();
            EXPECT_LT(pose_error(other, object.model_index, expected, twin->T_scene_model), 0.01);
            EXPECT_NEAR(twin->confidence, object.confidence, 0.05);
        }
    }
}

TEST(Recognize, TheOrderOfThePointsDoesNotMatter) {
    const SimulatedScene scene = tabletop({kPlate, kCorner}, 0);
    PointCloud shuffled = remove_invalid(scene.cloud);
    Random random(9);
    for (std::size_t i = shuffled.size() - 1; i > 0; --i) {
        std::swap(shuffled.points[i], shuffled.points[random.below(static_cast<std::uint32_t>(i))]);
    }
    expect_all(recognize(library(), shuffled), scene);
}

TEST(Recognize, OneThreadAndManyGiveTheSameBits) {
    const SimulatedScene scene = tabletop({kPlate, kCorner}, 3);
    set_thread_count(1);
    const Recognition one = recognize(library(), scene.cloud);
    set_thread_count(4);
    const Recognition four = recognize(library(), scene.cloud);
    set_thread_count(0);
    ASSERT_EQ(one.objects.size(), four.objects.size());
    ASSERT_FALSE(one.objects.empty());
    for (std::size_t i = 0; i < one.objects.size(); ++i) {
        const RecognizedObject& a = one.objects[i];
        const RecognizedObject& b = four.objects[i];
        EXPECT_EQ(a.model, b.model);
        EXPECT_EQ(a.T_scene_model.matrix(), b.T_scene_model.matrix());
        EXPECT_EQ(a.confidence, b.confidence);
        EXPECT_EQ(a.visible_fraction, b.visible_fraction);
        EXPECT_EQ(a.inlier_rms, b.inlier_rms);
        EXPECT_EQ(a.source, b.source);
    }
}

// What was reported, for messages.
std::string names(const Recognition& recognition) {
    std::string text;
    for (const RecognizedObject& object : recognition.objects) {
        text += object.model + " " + std::to_string(object.confidence) + " visible " +
                std::to_string(object.visible_fraction) + ", ";
    }
    return text;
}

// A ball of about a model's size.
TriangleMesh ball(double radius) {
    TriangleMesh mesh;
    constexpr std::uint32_t kRings = 24;
    constexpr std::uint32_t kSegments = 48;
    for (std::uint32_t ring = 0; ring <= kRings; ++ring) {
        for (std::uint32_t segment = 0; segment < kSegments; ++segment) {
            const double polar = kPi * ring / kRings;
            const double turn = 2.0 * kPi * segment / kSegments;
            mesh.vertices.push_back(Vec3d(radius * std::sin(polar) * std::cos(turn),
                                          radius * std::sin(polar) * std::sin(turn),
                                          radius * std::cos(polar))
                                        .cast<float>());
        }
    }
    for (std::uint32_t ring = 0; ring < kRings; ++ring) {
        for (std::uint32_t segment = 0; segment < kSegments; ++segment) {
            const std::uint32_t a = ring * kSegments + segment;
            const std::uint32_t b = ring * kSegments + (segment + 1) % kSegments;
            mesh.triangles.push_back({a, a + kSegments, b});
            mesh.triangles.push_back({b, a + kSegments, b + kSegments});
        }
    }
    return mesh;
}

TEST(Recognize, ReportsNothingWhereNoModelIs) {
    const Recognizer recognizer(library());
    const SceneModels balls = scene_models({ball(45.0)});
    const std::vector<std::uint32_t> chosen = {0, 0};
    for (std::uint64_t number = 0; number < 3; ++number) {
        const SimulatedScene scene =
            simulate_tabletop(balls, chosen, number, {.spacing = 1.3, .min_elevation = 0.6});
        EXPECT_EQ(names(recognizer.recognize(scene.cloud)), "") << number;
    }
    // A corner of a room: floor and two walls.
    TriangleMesh room;
    testing::add_box(room, Vec3f(-400, -400, -10), Vec3f(400, 400, 0));
    testing::add_box(room, Vec3f(-410, -400, 0), Vec3f(-400, 400, 500));
    testing::add_box(room, Vec3f(-400, 400, 0), Vec3f(400, 410, 500));
    const SceneModels rooms = scene_models({room});
    const PlacedModel placed{0, Pose::Identity()};
    for (const double noise : {0.0, 0.5}) {
        SceneView view{.T_camera_world = look_at(Vec3d(350, -350, 400), Vec3d(-300, 300, 0))};
        view.sensor.ranging.noise = noise;
        const SimulatedScene scene = simulate_scene(rooms, {&placed, 1}, view);
        EXPECT_EQ(names(recognizer.recognize(scene.cloud)), "") << noise;
    }
}

// Their tops are one plane, larger than any of them: from afar it looks like a table's or a wall's.
TEST(Recognize, FindsBoxesSideBySide) {
    TriangleMesh box;
    testing::add_box(box, Vec3f(-50, -30, 0), Vec3f(50, 30, 35));
    const ModelLibrary boxes =
        build_library(std::vector<ModelSource>{{"box", box}}, testing::quick_settings());
    const Recognizer recognizer(boxes);
    const SceneModels models = scene_models({box});
    std::vector<PlacedModel> placed;
    for (int i = 0; i < 6; ++i) {
        PlacedModel one{0, Pose::Identity()};
        one.T_world_model.translation() = Vec3d(106.0 * (i % 2) - 53.0, 66.0 * (i / 2) - 66.0, 0.0);
        placed.push_back(one);
    }
    SceneView view{.T_camera_world = look_at(Vec3d(120, -330, 480), Vec3d::Zero())};
    view.sensor.ranging.noise = 0.3;
    view.table_size = 1000.0;
    const SimulatedScene scene = simulate_scene(models, placed, view);
    const Recognition result = recognizer.recognize(scene.cloud);
    EXPECT_EQ(result.objects.size(), 6U);
    for (const TrueObject& truth : scene.objects) {
        double least = 1.0;
        for (const RecognizedObject& object : result.objects) {
            least =
                std::min(least, pose_error(boxes, 0, truth.T_scene_model, object.T_scene_model));
        }
        EXPECT_LT(least, 0.01);
    }
}

TEST(Recognize, TheThresholdDecidesWhatIsReported) {
    const SimulatedScene scene = tabletop({kPlate, kCorner}, 0);
    EXPECT_TRUE(recognize(library(), scene.cloud, {.min_confidence = 1.1}).objects.empty());
    const auto objects = recognize(library(), scene.cloud).objects;
    EXPECT_TRUE(std::is_sorted(objects.begin(), objects.end(), [](const auto& a, const auto& b) {
        return a.confidence > b.confidence;
    }));
}

// With its twin in the library, which of the two it is nobody can tell.
TEST(Recognize, AModelThatAnotherMatchesAsWellIsLessSure) {
    std::vector<ModelSource> sources = testing::simple_models();
    sources.push_back({.name = "twin", .mesh = testing::corner_model()});
    const ModelLibrary twins = build_library(sources, testing::quick_settings());
    const Recognizer recognizer(twins);
    const SimulatedScene scene = tabletop({kCorner}, 1);
    const Recognition sure = recognizer.recognize(scene.cloud, {.only = {kCorner, kPlate}});
    const Recognition doubtful = recognizer.recognize(scene.cloud, {.min_confidence = 0.01});
    const auto rivalry = [](const RecognizedObject& object) {
        return object.features[static_cast<std::size_t>(Feature::rival)];
    };
    ASSERT_EQ(sure.objects.size(), 1U);
    EXPECT_LT(rivalry(sure.objects[0]), 0.5);
    EXPECT_GT(sure.objects[0].confidence, 0.9);
    ASSERT_GE(doubtful.objects.size(), 1U);
    const RecognizedObject& either = doubtful.objects[0];
    EXPECT_GT(rivalry(either), 0.9);
    // Nearly half each: neither model's odds differ much.
    EXPECT_LT(either.confidence, 0.6);
    EXPECT_GT(either.confidence, 0.4);
    EXPECT_EQ(either.rival, either.model == "twin" ? "corner" : "twin");
    EXPECT_LT(either.confidence, sure.objects[0].confidence);
    EXPECT_DOUBLE_EQ(either.confidence, doubtful.judge.confidence(either.features));
}

TEST(Recognize, LibraryAndScanInMetersGiveTheSameObjects) {
    std::vector<ModelSource> in_meters = testing::simple_models();
    for (ModelSource& model : in_meters) model.mesh = scaled(model.mesh, 0.001);
    LibrarySettings settings = testing::quick_settings();
    settings.unit = Unit::meter;
    settings.sampling *= 0.001;
    const ModelLibrary other = build_library(in_meters, settings);
    const SimulatedScene scene = tabletop({kPlate, kCorner}, 1);
    const Recognition result = recognize(other, scaled(scene.cloud, 0.001));
    ASSERT_EQ(result.objects.size(), 2U);
    for (const TrueObject& truth : scene.objects) {
        const RecognizedObject* object = find(result, truth.model);
        ASSERT_NE(object, nullptr);
        Pose expected = truth.T_scene_model;
        expected.translation() *= 0.001;
        EXPECT_LT(pose_error(other, truth.model, expected, object->T_scene_model), 0.02);
    }
}

void expect_one_line(const PointCloud& scene, const std::string& what) {
    try {
        recognize(library(), scene);
        FAIL() << what << ": accepted";
    } catch (const InvalidInput& error) {
        const std::string message = error.what();
        EXPECT_EQ(message.find('\n'), std::string::npos) << what << ": " << message;
        EXPECT_GT(message.size(), 10U) << what;
    }
}

TEST(Recognize, HostileScansAreRefusedInOneLine) {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    PointCloud scene;
    expect_one_line(scene, "no points");
    scene.points = {Vec3f(0, 0, 300), Vec3f(10, 0, 300), Vec3f(0, 10, 300)};
    expect_one_line(scene, "3 points");
    scene.points.assign(5000, Vec3f::Constant(kNan));
    expect_one_line(scene, "all NaN");
    scene.points.assign(5000, Vec3f(1, 2, 300));
    expect_one_line(scene, "all equal");
    const PointCloud good = tabletop({kCorner}, 0).cloud;
    expect_one_line(scaled(good, 1000.0), "1000x too large");
    expect_one_line(scaled(good, 0.001), "1000x too small");
    scene.points.assign(5000, Vec3f(0, 0, 0));
    expect_one_line(scene, "at the sensor");
    scene.points.clear();
    for (int i = 0; i < 500; ++i) scene.points.emplace_back(static_cast<float>(i), 0.0F, 300.0F);
    expect_one_line(scene, "a line");
    for (Vec3f& point : scene.points) point *= 1e30F;
    expect_one_line(scene, "beyond float");
}

TEST(Recognize, RefusesALibraryWithoutModels) {
    const ModelLibrary none;
    EXPECT_THROW(recognize(none, tabletop({kCorner}, 0).cloud), InvalidInput);
}

}  // namespace
}  // namespace ostraka
