%% Getting started with roburoc4
% These lines drive a simulated robot. It runs in virtual time, so they take a second. For a real
% one write |r = roburoc4.Robot('192.168.0.2')|, and read docs/SAFETY.md first: a RobuROC4 weighs 140 kg.

% SPDX-License-Identifier: MIT
sim = roburoc4.Simulator();
r = sim.connect();

%% One metre ahead, and a quarter turn
% Driving must be allowed first; [A] on the game pad or an emergency stop ends that.
r.arm();
r.move(1);
r.turn(pi / 2);

%% Where it is now
p = r.pose;
fprintf('x %.2f m, heading %.0f degrees\n', p(1), p(3) * 180 / pi);

%% Two seconds of statuses
data = r.record(2);
plot(data.telemeter.time_s, data.telemeter.distances_m);
xlabel('time, s'); ylabel('telemeters, m');

%% The end
% This also stops a real robot, and so does clear r.
delete(r);
delete(sim);

%% Read on
% |help roburoc4| lists everything, |help roburoc4.Robot| what a robot can do. The examples are
% |drive_square|, |read_and_plot|, |speed_response| and |pure_pursuit|.
