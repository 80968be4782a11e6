// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/picture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/recognition/canvas.hpp"
#include "ostraka/recognition/contact_sheet.hpp"
#include "ostraka/recognition/label_layout.hpp"
#include "ostraka/recognition/picture_camera.hpp"
#include "ostraka/views/render.hpp"

namespace ostraka {
namespace {

constexpr double kRadius = 50.0;
constexpr double kDistance = 400.0;

TriangleMesh sphere(double radius) {
    constexpr int kRings = 48;
    constexpr int kSegments = 96;
    TriangleMesh mesh;
    for (int ring = 0; ring <= kRings; ++ring) {
        for (int segment = 0; segment < kSegments; ++segment) {
            const double polar = kPi * ring / kRings;
            const double turn = 2.0 * kPi * segment / kSegments;
            const Vec3d point(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn),
                              std::cos(polar));
            mesh.vertices.emplace_back((radius * point).cast<float>());
        }
    }
    for (std::uint32_t ring = 0; ring < kRings; ++ring) {
        for (std::uint32_t segment = 0; segment < kSegments; ++segment) {
            const std::uint32_t next = (segment + 1) % kSegments;
            const std::uint32_t a = ring * kSegments + segment;
            const std::uint32_t b = ring * kSegments + next;
            mesh.triangles.push_back({a, a + kSegments, b});
            mesh.triangles.push_back({b, a + kSegments, b + kSegments});
        }
    }
    return mesh;
}

// A rectangle across the view.
TriangleMesh board(double left, double right, double half_height, double z) {
    TriangleMesh mesh;
    for (const auto& [x, y] : {std::pair(left, -half_height), std::pair(right, -half_height),
                               std::pair(right, half_height), std::pair(left, half_height)}) {
        mesh.vertices.emplace_back(Vec3d(x, y, z).cast<float>());
    }
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

ModelLibrary sphere_library() {
    ModelLibrary library;
    library.settings.sampling = 1.0;
    Model model;
    model.name = "ball";
    model.mesh = sphere(kRadius);
    model.shape = measure(model.mesh);
    model.surface.points = model.mesh.vertices;
    library.models.push_back(model);
    return library;
}

Pose placed_at(const Vec3d& center) {
    Pose T_scene_model = Pose::Identity();
    T_scene_model.translation() = center;
    return T_scene_model;
}

Recognition found(const std::vector<Vec3d>& centers) {
    Recognition recognition;
    for (const Vec3d& center : centers) {
        RecognizedObject object;
        object.model = "ball";
        object.model_index = 0;
        object.T_scene_model = placed_at(center);
        object.confidence = 0.875;
        recognition.objects.push_back(object);
    }
    return recognition;
}

// The ball before a wall; with a board that hides its right half, if wanted.
PointCloud scan(bool hide_right_half) {
    std::vector<TriangleMesh> meshes = {
        transformed(sphere(kRadius), placed_at(Vec3d(0.0, 0.0, kDistance))),
        board(-160.0, 160.0, 120.0, 600.0)};
    if (hide_right_half) meshes.push_back(board(0.0, 60.0, 70.0, 300.0));
    return render(RayScene(std::move(meshes)), PinholeCamera{}, Pose::Identity()).cloud;
}

PointCloud unorganized(PointCloud cloud) {
    cloud.width = 0;
    cloud.height = 0;
    return cloud;
}

PictureSettings bare() {
    PictureSettings settings;
    settings.width = 640;
    settings.labels = false;
    settings.header = false;
    return settings;
}

// Largest difference between a pixel's channels: 0 for gray (the pictures' grays stay below 12).
int saturation(const Color& color) {
    const auto [low, high] = std::minmax_element(color.begin(), color.end());
    return *high - *low;
}

const Color& pixel_at(const Image& image, const Vec2d& place) {
    const auto x = static_cast<std::size_t>(std::lround(place.x()));
    const auto y = static_cast<std::size_t>(std::lround(place.y()));
    return image.pixels[y * static_cast<std::size_t>(image.width) + x];
}

// Where a point in the scan's frame appears in a picture with the settings bare().
Vec2d seen_at(const PointCloud& scene, const Recognition& recognition, const Vec3d& point) {
    std::vector<Vec3f> objects;
    for (const RecognizedObject& object : recognition.objects) {
        for (const Vec3f& vertex : sphere(kRadius).vertices) {
            objects.emplace_back(Vec3d(object.T_scene_model * vertex.cast<double>()).cast<float>());
        }
    }
    const PictureCamera camera = fit_camera(scene, objects, bare().width, 0);
    return camera.pinhole.project(camera.T_camera_scene * point);
}

TEST(Canvas, FillsExactlyTheRectangleAndClipsIt) {
    Image image = blank_image(5, 4, {10, 20, 30});
    fill(image, {-2, 1, 4, 2}, {110, 120, 131}, 0.5);
    for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < 5; ++x) {
            const bool inside = x < 2 && y >= 1 && y < 3;
            const Color expected = inside ? Color{60, 70, 81} : Color{10, 20, 30};
            EXPECT_EQ(image.pixels[static_cast<std::size_t>(y * 5 + x)], expected);
        }
    }
    EXPECT_THROW(blank_image(0, 4, {}), InvalidInput);
}

TEST(Canvas, FramesTouchEveryBorderPixelOnce) {
    Image image = blank_image(7, 6, {0, 0, 0});
    frame(image, {1, 1, 5, 4}, 1, {200, 100, 50}, 0.5);
    for (int y = 0; y < 6; ++y) {
        for (int x = 0; x < 7; ++x) {
            const bool inside = x >= 1 && x <= 5 && y >= 1 && y <= 4;
            const bool border = inside && (x == 1 || x == 5 || y == 1 || y == 4);
            const Color expected = border ? Color{100, 50, 25} : Color{0, 0, 0};
            EXPECT_EQ(image.pixels[static_cast<std::size_t>(y * 7 + x)], expected) << x << ' ' << y;
        }
    }
}

TEST(Canvas, ALineOfWidthOneOnPixelCentersIsExact) {
    Image image = blank_image(9, 5, {0, 0, 0});
    draw_line(image, {2.0, 2.0}, {6.0, 2.0}, 1.0, {255, 255, 255});
    for (int y = 0; y < 5; ++y) {
        for (int x = 0; x < 9; ++x) {
            const bool on = y == 2 && x >= 2 && x <= 6;
            const Color expected = on ? Color{255, 255, 255} : Color{0, 0, 0};
            EXPECT_EQ(image.pixels[static_cast<std::size_t>(y * 9 + x)], expected) << x << ' ' << y;
        }
    }
}

TEST(Canvas, RoundedCornersStayEmptyAndTheAreaIsThatOfTheShape) {
    Image image = blank_image(60, 50, {0, 0, 0});
    fill_rounded(image, {10, 5, 40, 30}, 10.0, {255, 255, 255});
    EXPECT_EQ(image.pixels[5 * 60 + 10], (Color{0, 0, 0}));
    EXPECT_EQ(image.pixels[5 * 60 + 30], (Color{255, 255, 255}));
    EXPECT_EQ(image.pixels[20 * 60 + 10], (Color{255, 255, 255}));
    double area = 0.0;
    for (const Color& pixel : image.pixels) area += pixel[0] / 255.0;
    EXPECT_NEAR(area, 40.0 * 30.0 - (4.0 - kPi) * 100.0, 4.0);
}

TEST(Canvas, EveryPrintableCharacterHasItsOwnShapeInsideItsWidth) {
    std::vector<std::vector<Color>> shapes;
    for (char character = 33; character <= 126; ++character) {
        const std::string text(1, character);
        Image image = blank_image(60, 60, {0, 0, 0});
        draw_text(image, {10.0, 10.0}, text, 18.0, {255, 255, 255});
        const double right = 10.0 + text_width(text, 18.0);
        for (std::size_t i = 0; i < image.pixels.size(); ++i) {
            if (image.pixels[i][0] == 0) continue;
            EXPECT_GE(i % 60, 7U) << text;
            EXPECT_LE(static_cast<double>(i % 60), right) << text;
            EXPECT_GE(i / 60, 7U) << text;
            EXPECT_LE(i / 60, 34U) << text;
        }
        const auto bright = std::count_if(image.pixels.begin(), image.pixels.end(),
                                          [](const Color& pixel) { return pixel[0] > 128; });
        EXPECT_GT(bright, 3) << text;
        EXPECT_EQ(std::find(shapes.begin(), shapes.end(), image.pixels), shapes.end()) << text;
        shapes.push_back(image.pixels);
    }
}

TEST(Canvas, TextWidthAddsUpAndForeignCharactersCountOnce) {
    EXPECT_DOUBLE_EQ(text_width("ab c", 9.0), text_width("ab", 9.0) + text_width(" c", 9.0));
    EXPECT_DOUBLE_EQ(text_width("\xC3\xA4", 9.0), text_width("?", 9.0));
    EXPECT_EQ(shortened("flange", 9.0, 1000.0), "flange");
    const std::string brief = shortened("a very long name of a part", 9.0, 80.0);
    EXPECT_LE(text_width(brief, 9.0), 80.0);
    EXPECT_EQ(brief.substr(brief.size() - 2), "..");
}

TEST(LabelLayout, BoxesAreInsideApartAndOffTheObjects) {
    LabelSpace space{{10, 20, 600, 400}, 640, std::vector<float>(640 * 480, 0.0F)};
    for (std::size_t y = 150; y < 300; ++y) {
        for (std::size_t x = 200; x < 400; ++x) space.cost[y * 640 + x] = 1.0F;
    }
    const std::vector<LabelRequest> requests(9, {Vec2d(300.0, 220.0), 120, 30});
    const auto boxes = place_labels(requests, space);
    ASSERT_EQ(boxes.size(), requests.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        ASSERT_TRUE(boxes[i]);
        EXPECT_GE(boxes[i]->x, 10);
        EXPECT_GE(boxes[i]->y, 20);
        EXPECT_LE(boxes[i]->right(), 610);
        EXPECT_LE(boxes[i]->bottom(), 420);
        EXPECT_FALSE(overlap(*boxes[i], {210, 160, 180, 130}));
        for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(overlap(*boxes[i], *boxes[j]));
    }
}

TEST(LabelLayout, SaysWhenNoRoomIsLeft) {
    const LabelSpace space{{0, 0, 100, 40}, 100, std::vector<float>(4000, 0.0F)};
    const std::vector<LabelRequest> requests(2, {Vec2d(50.0, 20.0), 90, 30});
    const auto boxes = place_labels(requests, space);
    EXPECT_TRUE(boxes[0]);
    EXPECT_FALSE(boxes[1]);
}

class PictureOfBall : public testing::TestWithParam<bool> {
  protected:
    PointCloud view(bool hide_right_half) const {
        return GetParam() ? scan(hide_right_half) : unorganized(scan(hide_right_half));
    }
};
INSTANTIATE_TEST_SUITE_P(Organized, PictureOfBall, testing::Bool());

TEST_P(PictureOfBall, IsColoredWhereTheModelIsAndNowhereElse) {
    const PointCloud scene = view(false);
    const Recognition recognition = found({Vec3d(0.0, 0.0, kDistance)});
    const Image image = draw_recognition(scene, sphere_library(), recognition, bare());
    const Vec2d center = seen_at(scene, recognition, Vec3d(0.0, 0.0, kDistance));
    // A point on the contour: the ball's polar circle as seen from the origin.
    const double sine = kRadius / kDistance;
    const Vec3d contour(kRadius * std::sqrt(1.0 - sine * sine), 0.0,
                        kDistance * (1.0 - sine * sine));
    const double radius = (seen_at(scene, recognition, contour) - center).norm();
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const double distance = (Vec2d(x, y) - center).norm();
            const int colored = saturation(pixel_at(image, Vec2d(x, y)));
            if (distance < radius - 4.0) {
                ASSERT_GT(colored, 60) << x << ' ' << y;
            }
            if (distance > radius + 4.0) {
                ASSERT_LT(colored, 14) << x << ' ' << y;
            }
        }
    }
}

TEST_P(PictureOfBall, IsFaintWhereTheModelIsHidden) {
    const PointCloud scene = view(true);
    const Recognition recognition = found({Vec3d(0.0, 0.0, kDistance)});
    const Image image = draw_recognition(scene, sphere_library(), recognition, bare());
    const Vec3d front(0.0, 0.0, kDistance - kRadius);
    const Vec2d seen = seen_at(scene, recognition, front - Vec3d(20.0, 0.0, 0.0));
    const Vec2d hidden = seen_at(scene, recognition, front + Vec3d(20.0, 0.0, 0.0));
    EXPECT_GT(saturation(pixel_at(image, seen)), 100);
    EXPECT_GT(saturation(pixel_at(image, hidden)), 14);
    EXPECT_LT(saturation(pixel_at(image, hidden)), 70);
}

TEST_P(PictureOfBall, IsNotColoredWhereTheModelIsWrong) {
    const PointCloud scene = view(false);
    const Recognition recognition = found({Vec3d(0.0, 0.0, kDistance + 30.0)});
    const Image image = draw_recognition(scene, sphere_library(), recognition, bare());
    const Vec2d center = seen_at(scene, recognition, Vec3d(0.0, 0.0, kDistance));
    EXPECT_LT(saturation(pixel_at(image, center)), 70);
}

TEST(Picture, EachObjectHasItsOwnColor) {
    std::vector<TriangleMesh> meshes;
    const std::vector<Vec3d> centers = {Vec3d(-80.0, 0.0, kDistance), Vec3d(80.0, 0.0, kDistance)};
    for (const Vec3d& center : centers) {
        meshes.push_back(transformed(sphere(kRadius), placed_at(center)));
    }
    const PointCloud scene =
        render(RayScene(std::move(meshes)), PinholeCamera{}, Pose::Identity()).cloud;
    const Recognition recognition = found(centers);
    const Image image = draw_recognition(scene, sphere_library(), recognition, bare());
    const Color left = pixel_at(image, seen_at(scene, recognition, centers[0]));
    const Color right = pixel_at(image, seen_at(scene, recognition, centers[1]));
    EXPECT_GT(left[0], left[2]);    // object_color(0) is orange
    EXPECT_GT(right[2], right[0]);  // object_color(1) is blue
}

TEST(Picture, LabelsLieInsideAndBelowTheHeader) {
    const PointCloud scene = scan(false);
    const std::vector<Vec3d> centers(6, Vec3d(0.0, 0.0, kDistance));
    PictureSettings settings;
    settings.width = 640;
    const Image labeled = draw_recognition(scene, sphere_library(), found(centers), settings);
    settings.labels = false;
    const Image plain = draw_recognition(scene, sphere_library(), found(centers), settings);
    ASSERT_EQ(labeled.pixels.size(), plain.pixels.size());
    std::size_t changed = 0;
    for (int y = 0; y < plain.height; ++y) {
        for (int x = 0; x < plain.width; ++x) {
            if (pixel_at(labeled, Vec2d(x, y)) == pixel_at(plain, Vec2d(x, y))) continue;
            ++changed;
            EXPECT_TRUE(x >= 2 && x < plain.width - 2 && y >= 27 && y < plain.height - 2);
        }
    }
    EXPECT_GT(changed, 6U * 1000U);
}

TEST(Picture, TheNumberOfThreadsDoesNotMatter) {
    const PointCloud scene = unorganized(scan(true));
    const Recognition recognition = found({Vec3d(0.0, 0.0, kDistance)});
    set_thread_count(1);
    const Image one = draw_recognition(scene, sphere_library(), recognition);
    set_thread_count(0);
    const Image all = draw_recognition(scene, sphere_library(), recognition);
    EXPECT_EQ(one.pixels, all.pixels);
}

TEST(Picture, RowsOfAnOrganizedScanStayHorizontalHoweverItsFrameIsTurned) {
    const PointCloud scene = scan(true);
    Pose T_new_scene = Pose::Identity();
    T_new_scene.linear() =
        Eigen::AngleAxisd(2.0, Vec3d(0.3, -0.5, 0.7).normalized()).toRotationMatrix();
    T_new_scene.translation() = Vec3d(100.0, -30.0, 70.0);
    Recognition recognition = found({Vec3d(0.0, 0.0, kDistance)});
    const Image before = draw_recognition(scene, sphere_library(), recognition, bare());
    recognition.objects[0].T_scene_model = T_new_scene * recognition.objects[0].T_scene_model;
    PointCloud turned = transformed(scene, T_new_scene);
    turned.width = scene.width;
    turned.height = scene.height;
    const Image after = draw_recognition(turned, sphere_library(), recognition, bare());
    ASSERT_EQ(before.width, after.width);
    ASSERT_EQ(before.height, after.height);
    double difference = 0.0;
    for (std::size_t i = 0; i < before.pixels.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            difference += std::abs(before.pixels[i][c] - after.pixels[i][c]);
        }
    }
    EXPECT_LT(difference / static_cast<double>(before.pixels.size()), 1.0);
}

std::size_t count_bright_text(const Image& image) {
    return static_cast<std::size_t>(
        std::count(image.pixels.begin(), image.pixels.end(), Color{240, 242, 246}));
}

TEST(Picture, SaysWhenNothingWasFoundUnlessWordsAreUnwanted) {
    const PointCloud scene = scan(false);
    PictureSettings settings = bare();
    EXPECT_LT(count_bright_text(draw_recognition(scene, sphere_library(), {}, settings)), 5U);
    settings.labels = true;
    const Image nothing = draw_recognition(scene, sphere_library(), {}, settings);
    EXPECT_GT(count_bright_text(nothing), 50U);
    settings.labels = false;
    const Recognition one = found({Vec3d(0.0, 0.0, kDistance)});
    EXPECT_LT(count_bright_text(draw_recognition(scene, sphere_library(), one, settings)), 5U);
}

TEST(Picture, DrawsScansWithHardlyAnyPointsAndFromWithin) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    PointCloud cloud;
    EXPECT_GT(draw_recognition(cloud, {}, {}).height, 0);
    cloud.points = {Vec3f(nan, nan, nan)};
    cloud.width = cloud.height = 1;
    EXPECT_GT(draw_recognition(cloud, {}, {}).height, 0);
    cloud.points = {Vec3f(0.0F, 0.0F, 5.0F)};
    EXPECT_GT(draw_recognition(cloud, {}, {}).height, 0);
    cloud.points = {Vec3f::Zero()};  // at the viewpoint itself
    EXPECT_GT(draw_recognition(cloud, {}, {}).height, 0);
    PointCloud around;
    around.points = sphere(100.0).vertices;
    const Recognition recognition = found({Vec3d(0.0, 0.0, 0.0)});
    EXPECT_GT(draw_recognition(around, sphere_library(), recognition).height, 0);
    EXPECT_GT(draw_recognition({}, sphere_library(), recognition).height, 0);
}

TEST(Picture, RejectsWhatItCannotDraw) {
    PictureSettings settings;
    settings.width = 100;
    EXPECT_THROW(draw_recognition(scan(false), sphere_library(), {}, settings), InvalidInput);
    const Recognition recognition = found({Vec3d(0.0, 0.0, kDistance)});
    EXPECT_THROW(draw_recognition(scan(false), {}, recognition), InvalidInput);
    EXPECT_THROW(overlay_cloud(scan(false), {}, recognition), InvalidInput);
}

TEST(OverlayCloud, HoldsTheScanAndThePlacedSurface) {
    const PointCloud scene = scan(false);
    const std::size_t valid = remove_invalid(scene).size();
    const Vec3d center(0.0, 0.0, kDistance);
    const PointCloud overlay = overlay_cloud(scene, sphere_library(), found({center}));
    check(overlay);
    ASSERT_EQ(overlay.size(), valid + sphere(kRadius).vertices.size());
    for (std::size_t i = 0; i < overlay.size(); ++i) {
        if (i < valid) {
            EXPECT_LT(saturation(overlay.colors[i]), 14);
        } else {
            EXPECT_EQ(overlay.colors[i], object_color(0));
            EXPECT_NEAR((overlay.points[i].cast<double>() - center).norm(), kRadius, 1e-3);
        }
    }
}

ModelLibrary library_with_entries(std::size_t entries) {
    ModelLibrary library = sphere_library();
    for (std::size_t i = 0; i < entries; ++i) {
        Entry entry;
        entry.view = static_cast<int>(i);
        entry.direction = 0;
        entry.fraction = 1;
        entry.cloud.viewpoint = Vec3f(0.0F, 0.0F, 300.0F);
        for (const Vec3f& point : library.models[0].mesh.vertices) {
            if (point.z() > 0.0F && point.x() < 0.0F) entry.cloud.points.push_back(point);
        }
        library.entries.push_back(std::move(entry));
    }
    library.settings.sampling = 4.0;
    return library;
}

TEST(ContactSheet, ColorsTheHalfOfTheModelThatAnEntryHolds) {
    const ModelLibrary library = library_with_entries(1);
    ContactSheetSettings settings;
    const Image sheet = draw_contact_sheet(library, settings);
    std::size_t colored = 0;
    for (int y = 60; y < sheet.height; ++y) {
        for (int x = 0; x < sheet.width; ++x) {
            colored += saturation(pixel_at(sheet, Vec2d(x, y))) > 60 ? 1U : 0U;
        }
    }
    const double radius = 0.47 * settings.tile;
    EXPECT_NEAR(static_cast<double>(colored), 0.5 * kPi * radius * radius,
                0.12 * 0.5 * kPi * radius * radius);
}

TEST(ContactSheet, IsCappedAndIndependentOfThreads) {
    ContactSheetSettings settings;
    settings.tile = 64;
    settings.columns = 4;
    settings.entries = 6;
    set_thread_count(1);
    const Image one = draw_contact_sheet(library_with_entries(100), settings);
    set_thread_count(0);
    EXPECT_EQ(one.pixels, draw_contact_sheet(library_with_entries(100), settings).pixels);
    EXPECT_EQ(one.height, draw_contact_sheet(library_with_entries(6), settings).height);
    ModelLibrary many;
    many.models.assign(50, sphere_library().models[0]);
    ModelLibrary forty = many;
    forty.models.resize(40);
    EXPECT_EQ(draw_contact_sheet(many, settings).height,
              draw_contact_sheet(forty, settings).height);
}

TEST(ContactSheet, DrawsAnEmptyLibraryAndRejectsWrongSettings) {
    EXPECT_GT(draw_contact_sheet({}).height, 0);
    ContactSheetSettings settings;
    settings.columns = 0;
    EXPECT_THROW(draw_contact_sheet({}, settings), InvalidInput);
}

}  // namespace
}  // namespace ostraka
