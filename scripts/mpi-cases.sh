# What scripts/mpi.sh and scripts/hosts.sh run: arguments of nastic, to be sourced.

cases=examples/cases
short=(--set expect={})

# Eight scenarios, a checkpoint behind every iteration: what is interrupted.
long=(optimize $cases/robust_turgor.json "${short[@]}" --set optimizer/max_iterations=12 --set optimizer/tolerance=1e-12 --set output/checkpoint=1)

# Five scenarios of one motion, of which some take longer: members that move between ranks at checkpoints are solved again where they go.
motion=(optimize $cases/flick.json "${short[@]}" --set optimizer/max_iterations=5 --set output/checkpoint=2
  --set 'mesh/box/cells=[5,1,1]' --set 'time/end=120 ms' --set 'time/step=10 ms' --set 'time/output=40 ms'
  --set 'controls/0/in_time/every=40 ms' --set 'costs/0/when={"at":["100 ms","120 ms"]}'
  --set 'scenarios=[{"set":{"materials/0/young":"0.25 MPa"}},{"set":{"materials/0/density":"900 kg/m^3"}},{"set":{"materials/0/young":"0.4 MPa"}},{"set":{"materials/0/density":"1200 kg/m^3"}},{"set":{"materials/0/maxwell/0/shear":"80 kPa"}}]')
