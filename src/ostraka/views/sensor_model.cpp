// SPDX-License-Identifier: Apache-2.0
#include "ostraka/views/sensor_model.hpp"

#include <algorithm>
#include <cmath>

#include "ostraka/base/parallel.hpp"
#include "ostraka/base/random.hpp"

namespace ostraka {
namespace {

// Independent streams of random numbers from one seed. The noise's own is the seed itself.
constexpr std::uint64_t kLossStream = 0x10550000ULL << 32U;
constexpr std::uint64_t kHoleStream = 0x401e0000ULL << 32U;
constexpr std::uint64_t kMixStream = 0x3189ed00ULL << 32U;

std::size_t pixel_count(const DepthImage& image) {
    return static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
}

void for_each_row(const DepthImage& image, const std::function<void(std::size_t)>& body) {
    parallel_for(static_cast<std::size_t>(image.height), body, 8);
}

// The neighbor across an edge, or the pixel itself where there is none. Of several the nearest to
// the sensor, because the nearer surface is what bleeds over.
std::size_t across_edge(const DepthImage& image, std::size_t row, std::size_t column, double step) {
    const auto width = static_cast<std::size_t>(image.width);
    const std::size_t pixel = row * width + column;
    const double depth = image.depths[pixel];
    std::size_t found = pixel;
    const auto consider = [&](std::size_t other) {
        const double there = image.depths[other];
        if (!(there > 0.0) || !(std::abs(there - depth) > step)) return;
        if (found == pixel || there < image.depths[found]) found = other;
    };
    if (column > 0) consider(pixel - 1);
    if (column + 1 < width) consider(pixel + 1);
    if (row > 0) consider(pixel - width);
    if (row + 1 < static_cast<std::size_t>(image.height)) consider(pixel + width);
    return found;
}

bool beside_nothing(const DepthImage& image, std::size_t row, std::size_t column) {
    const auto width = static_cast<std::size_t>(image.width);
    const std::size_t pixel = row * width + column;
    return (column > 0 && image.depths[pixel - 1] == 0.0) ||
           (column + 1 < width && image.depths[pixel + 1] == 0.0) ||
           (row > 0 && image.depths[pixel - width] == 0.0) ||
           (row + 1 < static_cast<std::size_t>(image.height) && image.depths[pixel + width] == 0.0);
}

double grazing_loss(double cosine, const SensorModel& sensor) {
    const double most = sensor.ranging.max_grazing_angle;
    if (cosine < std::cos(most)) return 1.0;
    const double free = sensor.free_grazing_angle;
    if (!(free < most) || cosine >= std::cos(free)) return 0.0;
    return (std::acos(std::min(1.0, cosine)) - free) / (most - free);
}

// Round patches: a Boolean model, whose disks cover 1 - exp(-density * mean area) of the plane.
// Their centers fall in the image and a margin as wide as the largest radius.
std::vector<char> holes(const DepthImage& image, const SensorModel& sensor) {
    std::vector<char> lost;
    if (!(sensor.holes > 0.0)) return lost;
    lost.assign(pixel_count(image), 0);
    // Radii are uniform from half to one and a half of the mean: the mean square is 13/12 of it.
    const double area = kPi * sensor.hole_size * sensor.hole_size * 13.0 / 12.0;
    const double density = -std::log(1.0 - std::min(0.99, sensor.holes)) / area;
    const double margin = 1.5 * sensor.hole_size;
    const double width = image.width + 2.0 * margin;
    const double height = image.height + 2.0 * margin;
    const auto count = static_cast<std::uint64_t>(std::llround(density * width * height));
    for (std::uint64_t i = 0; i < count; ++i) {
        Random random(sensor.ranging.seed ^ kHoleStream, i);
        const double x = random.uniform(0.0, width) - margin;
        const double y = random.uniform(0.0, height) - margin;
        const double radius = sensor.hole_size * random.uniform(0.5, 1.5);
        const int top = std::max(0, static_cast<int>(std::ceil(y - radius)));
        const int bottom = std::min(image.height - 1, static_cast<int>(std::floor(y + radius)));
        for (int row = top; row <= bottom; ++row) {
            const double half = std::sqrt(std::max(0.0, radius * radius - (row - y) * (row - y)));
            const int left = std::max(0, static_cast<int>(std::ceil(x - half)));
            const int right = std::min(image.width - 1, static_cast<int>(std::floor(x + half)));
            for (int column = left; column <= right; ++column) {
                lost[static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) +
                     static_cast<std::size_t>(column)] = 1;
            }
        }
    }
    return lost;
}

// The true depths without those that the sensor doesn't get.
std::vector<double> answered(const DepthImage& truth, const std::vector<char>& shadowed,
                             const SensorModel& sensor) {
    const std::vector<char> in_hole = holes(truth, sensor);
    const auto width = static_cast<std::size_t>(truth.width);
    const bool chance =
        sensor.dropout > 0.0 || sensor.free_grazing_angle < sensor.ranging.max_grazing_angle;
    std::vector<double> depths(pixel_count(truth), 0.0);
    for_each_row(truth, [&](std::size_t row) {
        for (std::size_t pixel = row * width; pixel < (row + 1) * width; ++pixel) {
            const double depth = truth.depths[pixel];
            if (!(depth > 0.0) || depth < sensor.min_depth || depth > sensor.max_depth) continue;
            if (!shadowed.empty() && shadowed[pixel] != 0) continue;
            if (!in_hole.empty() && in_hole[pixel] != 0) continue;
            const double grazing = grazing_loss(truth.cosines[pixel], sensor);
            const double loss = 1.0 - (1.0 - grazing) * (1.0 - sensor.dropout);
            if (loss >= 1.0) continue;
            if (chance && loss > 0.0 &&
                Random(sensor.ranging.seed ^ kLossStream, pixel).uniform() < loss) {
                continue;
            }
            depths[pixel] = depth;
        }
    });
    return depths;
}

// At an edge the sensor loses a pixel, or sees both surfaces at once.
void blur_edges(const DepthImage& truth, std::vector<double>& depths, const SensorModel& sensor) {
    if (!(sensor.edge_step > 0.0) || !(sensor.edge_dropout + sensor.mixed_pixels > 0.0)) return;
    const auto width = static_cast<std::size_t>(truth.width);
    for_each_row(truth, [&](std::size_t row) {
        for (std::size_t column = 0; column < width; ++column) {
            const std::size_t pixel = row * width + column;
            if (depths[pixel] == 0.0) continue;
            const std::size_t other = across_edge(truth, row, column, sensor.edge_step);
            const bool open = other == pixel && beside_nothing(truth, row, column);
            if (other == pixel && !open) continue;
            Random random(sensor.ranging.seed ^ kMixStream, pixel);
            const double chance = random.uniform();
            if (chance < sensor.edge_dropout) {
                depths[pixel] = 0.0;
            } else if (!open && chance < sensor.edge_dropout + sensor.mixed_pixels) {
                const double share = random.uniform();
                depths[pixel] = share * truth.depths[other] + (1.0 - share) * truth.depths[pixel];
            }
        }
    });
}

double normal_number(std::uint64_t pixel, const SensorModel& sensor) {
    return Random(sensor.ranging.seed, pixel).normal();
}

// Sums of normal numbers over windows along rows, then along columns, with deviation 1 again.
std::vector<double> smooth_noise(const DepthImage& image, const SensorModel& sensor) {
    const int half = sensor.noise_window / 2;
    const int columns = image.width + 2 * half;
    const int rows = image.height + 2 * half;
    const auto stride = static_cast<std::size_t>(image.width);
    std::vector<double> along(stride * static_cast<std::size_t>(rows));
    parallel_for(
        static_cast<std::size_t>(rows),
        [&](std::size_t row) {
            std::vector<double> numbers(static_cast<std::size_t>(columns));
            for (std::size_t c = 0; c < numbers.size(); ++c) {
                numbers[c] = normal_number(row * numbers.size() + c, sensor);
            }
            for (std::size_t c = 0; c < stride; ++c) {
                double sum = 0.0;
                for (int k = 0; k <= 2 * half; ++k) sum += numbers[c + static_cast<std::size_t>(k)];
                along[row * stride + c] = sum;
            }
        },
        8);
    std::vector<double> noise(pixel_count(image));
    const double scale = 1.0 / (2.0 * half + 1.0);
    for_each_row(image, [&](std::size_t row) {
        for (std::size_t c = 0; c < stride; ++c) {
            double sum = 0.0;
            for (int k = 0; k <= 2 * half; ++k) {
                sum += along[(row + static_cast<std::size_t>(k)) * stride + c];
            }
            noise[row * stride + c] = scale * sum;
        }
    });
    return noise;
}

double rounded(double depth, const SensorModel& sensor) {
    if (sensor.inverse_depth_step > 0.0) {
        const double steps = std::round(1.0 / (depth * sensor.inverse_depth_step));
        depth = steps > 0.0 ? 1.0 / (steps * sensor.inverse_depth_step) : 0.0;
    }
    const double step = sensor.ranging.quantization;
    return step > 0.0 ? std::round(depth / step) * step : depth;
}

}  // namespace

double noise_deviation(double depth, double cosine, const SensorModel& sensor) {
    double deviation = sensor.ranging.noise + sensor.noise_per_depth * depth +
                       sensor.ranging.noise_per_depth2 * depth * depth;
    if (sensor.grazing_noise > 0.0) {
        deviation /= std::pow(std::max(cosine, 0.05), sensor.grazing_noise);
    }
    return deviation;
}

std::vector<double> measured_depths(const DepthImage& truth, const std::vector<char>& shadowed,
                                    const SensorModel& sensor) {
    std::vector<double> depths = answered(truth, shadowed, sensor);
    blur_edges(truth, depths, sensor);
    const bool noisy = noise_deviation(1.0, 1.0, sensor) > 0.0;
    const bool smooth = noisy && sensor.noise_window > 1;
    const std::vector<double> noise = smooth ? smooth_noise(truth, sensor) : std::vector<double>();
    const auto width = static_cast<std::size_t>(truth.width);
    for_each_row(truth, [&](std::size_t row) {
        for (std::size_t pixel = row * width; pixel < (row + 1) * width; ++pixel) {
            double& depth = depths[pixel];
            if (depth == 0.0) continue;
            if (noisy) {
                const double number = smooth ? noise[pixel] : normal_number(pixel, sensor);
                depth += noise_deviation(depth, truth.cosines[pixel], sensor) * number;
            }
            depth = std::max(0.0, rounded(depth, sensor));
        }
    });
    return depths;
}

SensorModel scaled(SensorModel sensor, double factor) {
    sensor.ranging.noise *= factor;
    sensor.ranging.noise_per_depth2 /= factor;
    sensor.ranging.quantization *= factor;
    sensor.inverse_depth_step /= factor;
    sensor.min_depth *= factor;
    sensor.max_depth *= factor;
    sensor.projector *= factor;
    sensor.edge_step *= factor;
    return sensor;
}

}  // namespace ostraka
