function test_examples_draw_their_drives()
% Each example runs without a display, writes its plot, and drives what its help promises.
% SPDX-License-Identifier: MIT
folder = tempname();
mkdir(folder);
cleanup = onCleanup(@() remove(folder));
restored = without_display(); %#ok<NASGU>
data = read_and_plot([], fullfile(folder, 'matlab-read-and-plot.png'));
check(numel(data.localization.x_m) == 100 && max(data.differential.current_linear_m_s) > 0.3, 'nothing read');

track = drive_square([], fullfile(folder, 'matlab-square.png'));
check(abs(max(track(:, 1)) - 1.5) < 0.05 && abs(max(track(:, 2)) - 1.5) < 0.05, 'no square');
check(norm(track(end, 1:2)) < 0.1, 'it does not close, by odometry: %g m', norm(track(end, 1:2)));

fit = speed_response([], fullfile(folder, 'matlab-speed-response.png'));
check(abs(fit.natural_rad_s - 2.46) < 0.02 * 2.46, 'omega_n %g', fit.natural_rad_s);
check(abs(fit.damping - 0.79) < 0.02 * 0.79, 'zeta %g', fit.damping);
check(fit.rms_m_s < 0.005, 'the model misses by %g m/s', fit.rms_m_s);

[track, path] = pure_pursuit([], fullfile(folder, 'matlab-pure-pursuit.png'));
check(norm(track(end, 1:2) - path(end, :)) < 0.15, 'it did not reach the end');
worst_m = 0;
for k = 1:size(track, 1)
    worst_m = max(worst_m, sqrt(min(sum((path - repmat(track(k, 1:2), size(path, 1), 1)) .^ 2, 2))));
end
check(worst_m < 0.2, 'up to %g m beside the path', worst_m);

names = {'read-and-plot', 'square', 'speed-response', 'pure-pursuit'};
for k = 1:numel(names)
    picture = dir(fullfile(folder, ['matlab-' names{k} '.png']));
    check(numel(picture) == 1 && picture.bytes > 3000, 'no picture of %s', names{k});
end
end

function remove(folder)
if exist('OCTAVE_VERSION', 'builtin')
    confirm_recursive_rmdir(false, 'local');
end
rmdir(folder, 's');
end
