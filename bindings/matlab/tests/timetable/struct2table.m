function table = struct2table(columns)
%STRUCT2TABLE A stand-in for MATLAB's, for tests in Octave: each field has the same number of rows.
%
%   Example:
%      struct2table(struct('x_m', [1; 2]))

% SPDX-License-Identifier: MIT
row_counts = structfun(@(column) size(column, 1), columns);
check(all(row_counts == row_counts(1)), 'columns of different lengths');
table = columns;
end
