// An engine in C++ without libraries: a load that slides without turning, with exact friction.
//
//     c++ -O2 -o slider crates/engines/examples/slider.cpp
//     cohaul compare SCENE --engine ./slider
//
// Requests and answers are one JSON object a line. A program in earnest reads them with a library;
// here the keys that are needed are looked for by name.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string>

static double number(const std::string &line, const std::string &key, size_t from = 0) {
    size_t at = line.find("\"" + key + "\":", from);
    return at == std::string::npos ? 0.0 : std::strtod(line.c_str() + at + key.size() + 3, nullptr);
}

static void numbers(const std::string &line, const std::string &key, double *out, int n) {
    const char *at = line.c_str() + line.find("\"" + key + "\":[") + key.size() + 4;
    for (int i = 0; i < n; ++i) {
        char *end;
        out[i] = std::strtod(at, &end);
        at = end + 1;
    }
}

int main() {
    double pose[3], twist[3], mass = 1.0, grip = 0.0;
    for (std::string line; std::getline(std::cin, line);) {
        if (line.find("\"call\":\"start\"") != std::string::npos) {
            mass = number(line, "mass_kg");
            numbers(line, "pose", pose, 3);
            numbers(line, "twist", twist, 3);
            grip = 0.0;
            for (size_t at = 0; (at = line.find("\"slip_limit_n\":", at)) != std::string::npos; ++at)
                grip += number(line, "slip_limit_n", at);
            std::puts("{\"name\":\"slider\",\"version\":\"C++\"}");
        } else if (line.find("\"call\":\"advance\"") != std::string::npos) {
            int n = static_cast<int>(number(line, "n_steps"));
            double h = number(line, "duration_s") / n;
            for (int step = 1; step <= n; ++step) {
                std::printf("{\"ask\":\"wrench\",\"pose\":[%.17g,%.17g,%.17g],\"twist\":[%.17g,%.17g,0],\"share\":%.17g}\n",
                            pose[0], pose[1], pose[2], twist[0], twist[1], static_cast<double>(step) / n);
                std::fflush(stdout);
                std::string answer;
                if (!std::getline(std::cin, answer)) return 1;
                double force[2];
                numbers(answer, "wrench", force, 2);
                double u = twist[0] + h * force[0] / mass, v = twist[1] + h * force[1] / mass;
                double speed = std::hypot(u, v);
                double left = speed > 0 ? std::fmax(0.0, 1.0 - h * grip / mass / speed) : 0.0;
                twist[0] = left * u;
                twist[1] = left * v;
                pose[0] += h * twist[0];
                pose[1] += h * twist[1];
            }
            std::printf("{\"pose\":[%.17g,%.17g,%.17g],\"twist\":[%.17g,%.17g,0]}\n", pose[0], pose[1], pose[2], twist[0], twist[1]);
        } else {
            std::puts("{}");
        }
        std::fflush(stdout);
    }
    return 0;
}
