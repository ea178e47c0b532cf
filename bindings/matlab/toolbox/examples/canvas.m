function shown = canvas(live, width, height)
%CANVAS A figure of the examples: on the screen, or for a picture only.
%   SHOWN = canvas(LIVE, WIDTH, HEIGHT) makes a figure of this size in pixels, which is not shown
%   unless LIVE, with a light grid and clear lines.
%
%   Example:
%      shown = canvas(true, 800, 600); plot(rand(9, 1))
%
%   See also figure.

% SPDX-License-Identifier: MIT
visible = 'off';
if live
    visible = 'on';
end
shown = figure('visible', visible, 'Position', [100 100 width height], ...
    'PaperPositionMode', 'auto', 'DefaultAxesGridColor', [0.8 0.8 0.8], ...
    'DefaultAxesGridAlpha', 1, 'DefaultLineLineWidth', 3);
end
