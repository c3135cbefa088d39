// Checks deploy/k8s/aloft.yaml against the Kubernetes API's schemas, and what the parts must agree on.
// Usage: node kubernetes_test.mjs NODE_MODULES ALOFT_YAML
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {pathToFileURL} from 'node:url';

const [modules, file] = process.argv.slice(2);
const require = createRequire(modules + '/');
const yaml = require('js-yaml');

const objects = yaml.loadAll(readFileSync(file, 'utf8'));
const models = {};
for (const {apiVersion, kind} of objects) {
  const api = await import(pathToFileURL(`${modules}/kubernetes-models/${apiVersion}/index.js`));
  models[kind] = api[kind];
  assert.ok(models[kind], `the API ${apiVersion} has no ${kind}`);
}
const validate = object => new models[object.kind](object).validate();
for (const object of objects) validate(object);

// A wrong type and a missing field must be found, or the check above proves nothing.
const broken = structuredClone(objects.find(object => object.kind === 'StatefulSet'));
broken.spec.template.spec.containers[0].resources.limits.memory = {much: true};
assert.throws(() => validate(broken));
const incomplete = structuredClone(objects.find(object => object.kind === 'Deployment'));
delete incomplete.spec.selector;
assert.throws(() => validate(incomplete));

const byKind = kind => objects.find(object => object.kind === kind);
const service = byKind('Service');
const set = byKind('StatefulSet');
const workers = byKind('Deployment');
const includes = (labels, selector) => Object.entries(selector).every(([key, value]) => labels[key] === value);
assert.equal(set.spec.serviceName, service.metadata.name);
assert.equal(set.spec.replicas, 1);
assert.ok(includes(set.spec.template.metadata.labels, service.spec.selector));
assert.ok(!includes(workers.spec.template.metadata.labels, service.spec.selector));
for (const one of [set, workers]) assert.ok(includes(one.spec.template.metadata.labels, one.spec.selector.matchLabels));

const containers = [...set.spec.template.spec.containers, ...workers.spec.template.spec.containers];
for (const container of containers) {
  assert.ok(container.resources.limits.memory, `${container.name} has no memory limit`);
  const volumes = [...(set.spec.template.spec.volumes ?? []), ...workers.spec.template.spec.volumes,
    ...set.spec.volumeClaimTemplates.map(claim => claim.metadata)].map(volume => volume.name);
  for (const mount of container.volumeMounts ?? []) assert.ok(volumes.includes(mount.name), mount.name);
}
const metrics = containers.find(container => container.name === 'metrics');
const port = metrics.ports[0].containerPort;
assert.ok(metrics.args.includes(`--http-port=${port}`));
for (const probe of ['startupProbe', 'livenessProbe', 'readinessProbe']) assert.equal(metrics[probe].httpGet.path, '/healthz');

// All containers name the same run and the same port of the discovery server.
const values = flag => new Set(containers.flatMap(container => container.args.filter(text => text.startsWith(flag)))
  .map(text => text.replace(/^.*[=:]/, '')));
assert.equal(values('--discovery-server').size, 1);
assert.equal(new Set([...values('--run'), ...values('--join')]).size, 1);
console.log(`${objects.length} objects are valid`);
