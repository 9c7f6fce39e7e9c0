"""A bucket of moto_server for bucket.rs: `make PORT` makes one and prints who may write there, `list PORT KEY SECRET` prints
the SHA-256 of every object. From `make` on, the server looks at who asks."""

import hashlib
import json
import sys
import urllib.request

import boto3

BUCKET = "bucket"


def client(service, port, key="none", secret="none"):
    return boto3.client(
        service,
        endpoint_url=f"http://127.0.0.1:{port}",
        region_name="us-east-1",
        aws_access_key_id=key,
        aws_secret_access_key=secret,
    )


def make(port):
    client("s3", port).create_bucket(Bucket=BUCKET)
    iam = client("iam", port)
    iam.create_user(UserName="batch")
    statement = {"Effect": "Allow", "Action": "s3:*", "Resource": "*"}
    policy = json.dumps({"Version": "2012-10-17", "Statement": [statement]})
    iam.put_user_policy(UserName="batch", PolicyName="write", PolicyDocument=policy)
    made = iam.create_access_key(UserName="batch")["AccessKey"]
    # From now on no action is free.
    url, plain = f"http://127.0.0.1:{port}/moto-api/reset-auth", {"Content-Type": "text/plain"}
    urllib.request.urlopen(urllib.request.Request(url, data=b"0", headers=plain)).read()
    print(json.dumps({"key": made["AccessKeyId"], "secret": made["SecretAccessKey"]}))


def list_objects(port, key, secret):
    s3 = client("s3", port, key, secret)
    pages = s3.get_paginator("list_objects_v2").paginate(Bucket=BUCKET)
    names = [entry["Key"] for page in pages for entry in page.get("Contents", [])]
    read = lambda name: s3.get_object(Bucket=BUCKET, Key=name)["Body"].read()
    print(json.dumps({name: hashlib.sha256(read(name)).hexdigest() for name in names}))


{"make": make, "list": list_objects}[sys.argv[1]](*sys.argv[2:])
