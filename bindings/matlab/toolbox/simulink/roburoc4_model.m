function file = roburoc4_model(folder)
%ROBUROC4_MODEL Make an example model for Simulink: a simulated robot drives a circle.
%   FILE = roburoc4_model() writes roburoc4_circle.slx into the current folder; roburoc4_model(FOLDER)
%   writes it into another one. The model leaves its outputs in the workspace. For a real robot set
%   the block's address, and its clock to 'wall': it then needs 4 m by 4 m of FREE SPACE. It needs
%   Simulink R2021a or newer, and has not been run there yet.
%
%   Example:
%      roburoc4_model(); result = sim('roburoc4_circle'); plot(result.pose(:, 1), result.pose(:, 2))
%
%   See also roburoc4.System, roburoc4_library.

% SPDX-License-Identifier: MIT
if nargin < 1
    folder = pwd;
end
name = 'roburoc4_circle';
file = fullfile(folder, [name '.slx']);
load_system('simulink');
new_system(name);
set_param(name, 'Solver', 'FixedStepDiscrete', 'FixedStep', '0.05', 'StopTime', '20');
inputs = {'linear_m_s', '0.4'; 'angular_rad_s', '0.35'; 'arm', 'true'};
for k = 1:size(inputs, 1)
    add_block('simulink/Sources/Constant', [name '/' inputs{k, 1}], 'Value', inputs{k, 2}, ...
        'SampleTime', '0.05', 'Position', [40, 60 * k, 100, 60 * k + 30]);
end
robot = [name '/RobuROC4'];
add_block('simulink/User-Defined Functions/MATLAB System', robot, 'Position', [180 50 360 390]);
set_param(robot, 'System', 'roburoc4.System');
set_param(robot, 'sample_time_s', '0.05', 'max_linear_m_s', '0.5', 'max_angular_rad_s', '1');
outputs = {'pose', 'speeds', 'remaining_percent', 'state', 'distances_m', 'bumpers'};
for k = 1:numel(outputs)
    % Rows below each other: else each 1-by-3 row would be a page of its own.
    add_block('simulink/Sinks/To Workspace', [name '/' outputs{k}], 'VariableName', outputs{k}, ...
        'SaveFormat', 'Array', ...
        'Save2DSignal', '2-D array (concatenate along first dimension)', 'Position', [440, 60 * k, 560, 60 * k + 30]);
    add_line(name, sprintf('RobuROC4/%d', k), [outputs{k} '/1']);
end
for k = 1:size(inputs, 1)
    add_line(name, [inputs{k, 1} '/1'], sprintf('RobuROC4/%d', k));
end
save_system(name, file);
close_system(name);
end
